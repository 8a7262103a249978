"""Map the annotations of a specification to topics, types and fields that a node subscribes to and publishes."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, shown, with_article
from rtamt.extras import message_class
from rtamt.language.contents import types_of, variables
from rtamt.language.parsing.grammar import is_number
from rtamt.lazy.dataclasses import dataclass, field, replace
from rtamt.rewrite.check import unbounded_future
from rtamt.ros.fields import Path, check_path, path_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from rtamt.language.document import Document
    from rtamt.language.formula import Formula
    from rtamt.language.value_types import ValueType
    from rtamt.specification import Specification


@dataclass(frozen=True, slots=True)
class MessageType:
    """The type of a message, as the specification imports it: ``from rtamt_msgs.msg import FloatStamped``."""

    module: str
    name: str

    @property
    def ros(self) -> str:
        """The name in ROS: ``rtamt_msgs/FloatStamped``."""
        return f"{self.module.split('.')[0]}/{self.name}"

    def load(self) -> type:
        """Import the class; raise :class:`UsageError` if it is not a message class."""
        return message_class(self.module, self.name)


#: What may be published of an output; see :func:`bind`.
DELAYED, EAGER, INTERVAL = VERDICTS = ("delayed", "eager", "interval")
#: Of which instants bounds are published: of the start of the trace, or of all.
START, EVERY = INSTANTS = ("start", "every")

#: The default message type of a requirement.
NUMBER = MessageType("rtamt_msgs.msg", "FloatStamped")


@dataclass(frozen=True, slots=True)
class Input:
    """A variable whose values are messages: ``fields`` are the numbers that formulas read, by full name."""

    variable: str
    topic: str
    type: MessageType
    fields: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Output:
    """A requirement or assertion whose robustness is published: ``field`` is the number in the message."""

    name: str
    #: The variable that holds the message, and the field: ``rob.value``.
    field: str
    topic: str
    type: MessageType
    #: The requirement as a separate specification.
    specification: Specification
    #: What is published, if it is not the robustness of every sample: bounds and verdict at the start of the trace
    #: (:data:`START`), bounds of every instant (:data:`EVERY`), or verdicts once they are decided (:data:`EAGER`).
    early: str = ""

    @property
    def variable(self) -> str:
        """The variable that holds the message."""
        return self.field.split(".", maxsplit=1)[0]

    @property
    def path(self) -> Path:
        """The path to the number in the message."""
        return path_of(self.field)

    @property
    def verdicts(self) -> str:
        """The topic on which its verdicts are published."""
        return f"{self.topic}/verdict"

    @property
    def bounds(self) -> str:
        """The topic on which bounds and early verdicts are published."""
        return f"{self.topic}/bounds"


@dataclass(frozen=True, slots=True)
class Binding:
    """The topics, types and fields that a specification uses."""

    name: str
    inputs: tuple[Input, ...]
    outputs: tuple[Output, ...]
    #: The types of the fields that are Booleans or of an enumeration.
    value_types: Mapping[str, ValueType] = field(default_factory=dict)

    def check(self, load: Callable[[MessageType], Any] = MessageType.load) -> Mapping[MessageType, Any]:
        """Load every message type and check its fields; return the classes.

        ``load``: a function from a type to a class that can be called without arguments. Raises
        :class:`UsageError`.
        """
        kinds = [*(known.type for known in self.inputs), *(output.type for output in self.outputs)]
        classes = {kind: load(kind) for kind in dict.fromkeys(kinds)}
        for known in self.inputs:
            for name in known.fields:
                check_path(name, classes[known.type](), known.type.ros)
        for output in self.outputs:
            check_path(output.field, classes[output.type](), output.type.ros)
        return classes


def bind(spec: Specification, verdict: str | None = None, at: str | None = None) -> Binding:
    """Return the topics, types and fields that a specification names.

    ``verdict``: what is published of every output: ``"delayed"``, its robustness and verdict of every sample;
    ``"eager"``, the verdict of every instant once no later sample can change it; or ``"interval"``, bounds and
    verdict at the start of the trace, with ``at="every"`` bounds of every instant whenever they change. By default
    bounds at the start for unbounded future.

    Every assertion whose name is a field of a declared variable is published on that variable's topic. A
    variable without an annotation uses the topic ``rtamt/<name>``; so does a requirement with any other name, as
    ``rtamt_msgs/FloatStamped``. Other assertions are sub-formulas. Source: the paper's listing 8.

    Raises :class:`UsageError` if a variable is not a message, or there is nothing to publish.

    >>> import rtamt
    >>> binding = bind(rtamt.parse('''
    ...     from rtamt_msgs.msg import FloatStamped
    ...     input FloatStamped req  output FloatStamped rob
    ...     @ topic(rob, rtamt/rob)
    ...     rob.value = once[0:5](req.value >= 3)'''))
    >>> [(known.topic, known.fields) for known in binding.inputs], [known.topic for known in binding.outputs]
    ([('rtamt/req', ('req.value',))], ['rtamt/rob'])
    """
    spec.require_no_groups("a ROS node")
    document = spec.document
    types = _types(document)
    if verdict not in {None, *VERDICTS}:
        raise UsageError(f"the verdict is {shown(verdict)}; choose from {', '.join(VERDICTS)}")
    if at not in {None, *INSTANTS}:
        raise UsageError(f"at is {shown(at)}; choose from {', '.join(INSTANTS)}")
    if at is not None and verdict != INTERVAL:
        raise UsageError(f"at='{at}' belongs to verdict='{INTERVAL}'")
    outputs = tuple(
        replace(output, early=_early(output, verdict, at or START)) for output in _outputs(spec, types)
    )
    if not outputs:
        raise UsageError(
            "the specification publishes nothing: give the requirement the name of a field of a declared "
            "message, such as rob.value = always(...)"
        )
    formulas = [output.specification.formula for output in outputs]
    inputs = tuple(_inputs(formulas, document, types))
    _check_topics(inputs, outputs)
    return Binding(document.name or "rtamt", inputs, outputs, types_of(*formulas))


def _early(output: Output, verdict: str | None, at: str) -> str:
    """Return the form in which an output is published before the horizon; "" if it is not."""
    unbounded = unbounded_future(output.specification.formula) is not None
    if verdict is None:
        return START if unbounded else ""
    if verdict == INTERVAL and at == EVERY and unbounded:
        raise UsageError(
            f"'{output.name}' has unbounded future, so that its bounds are those of the start; leave out at='every'"
        )
    return {DELAYED: "", EAGER: EAGER, INTERVAL: at}[verdict]


def _types(document: Document) -> dict[str, MessageType]:
    """Return the type of every variable that holds a message."""
    imported = {known.name: MessageType(known.module, known.name) for known in document.imports}
    return {d.name: imported[d.type] for d in document.declarations if d.type in imported}


def _outputs(spec: Specification, types: Mapping[str, MessageType]) -> list[Output]:
    document = spec.document
    found = []
    required = {requirement.span: requirement.name for requirement in document.requirements}
    for assertion in document.assertions:
        variable = (assertion.name or "").split(".")[0]
        if assertion.name is not None and variable in types:
            if not path_of(assertion.name):
                raise UsageError(
                    f"'{variable}' is {with_article(types[variable].name)} and no number; "
                    f"say which field is the robustness, such as {variable}.value = ..."
                )
            topic, alone = _topic(document, variable), spec.select(assertion.name)
            found.append(Output(assertion.name, assertion.name, topic, types[variable], alone))
        elif assertion.span in required and not is_number(assertion.formula):
            name = required[assertion.span]
            topic = topic_of(name)
            field = f"{topic.rpartition('/')[2]}.value"
            found.append(Output(name, field, topic, NUMBER, spec.select(name)))
    return found


def topic_of(requirement: str) -> str:
    """Return the topic of a requirement that is not a field of a declared message.

    >>> topic_of("REQ-12.a"), topic_of("2nd")
    ('rtamt/REQ_12_a', 'rtamt/_2nd')
    """
    clean = re.sub(r"\W", "_", requirement, flags=re.ASCII)
    return f"rtamt/_{clean}" if clean[:1].isdigit() else f"rtamt/{clean}"


def _inputs(formulas: list[Formula], document: Document, types: Mapping[str, MessageType]) -> list[Input]:
    fields: dict[str, list[str]] = {}
    for name in dict.fromkeys(name for formula in formulas for name in variables(formula)):
        fields.setdefault(name.split(".")[0], []).append(name)
    found = []
    for variable, names in fields.items():
        if variable not in types:
            declared = {d.name: d.type for d in document.declarations}
            kind = declared.get(variable)
            what = "is not declared" if kind is None else f"is {with_article(kind)}"
            raise UsageError(
                f"'{variable}' {what}, and a topic carries messages: import a type and declare it, such as "
                f"'from std_msgs.msg import Float64' and 'input Float64 {variable}', then read {variable}.data"
            )
        if variable in names:
            raise UsageError(
                f"'{variable}' is {with_article(types[variable].name)} and no number; read one of its fields, "
                f"such as {variable}.value"
            )
        for name in names:
            path_of(name)
        found.append(Input(variable, _topic(document, variable), types[variable], tuple(names)))
    return found


def _topic(document: Document, variable: str) -> str:
    return document.topics.get(variable, f"rtamt/{variable}")


def _check_topics(inputs: tuple[Input, ...], outputs: tuple[Output, ...]) -> None:
    """Raise where a topic would have two uses."""
    read: dict[str, Input] = {}
    for known in inputs:
        other = read.setdefault(known.topic, known)
        if other.type != known.type:
            raise UsageError(
                f"'{other.variable}' and '{known.variable}' are on the topic {known.topic} with different types, "
                f"{other.type.ros} and {known.type.ros}"
            )
    written: dict[str, Output] = {}
    for output in outputs:
        if output.topic in read:
            raise UsageError(
                f"'{output.name}' would be published on {output.topic}, from which "
                f"'{read[output.topic].variable}' is read; give it a topic of its own: "
                f"@ topic({output.variable}, rtamt/{output.variable})"
            )
        twin = written.setdefault(output.topic, output)
        if twin is not output:
            raise UsageError(
                f"'{twin.name}' and '{output.name}' would both be published on {output.topic}; give each a "
                f"variable and a topic of its own"
            )


__all__ = ["Binding", "Input", "MessageType", "Output", "bind", "topic_of"]
