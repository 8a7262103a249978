"""The solver z3 behind a small face: terms, assumptions, and answers within a time limit.

A truth value is a Python ``bool`` or a :class:`Term`, a number a ``Fraction`` or a :class:`Term`; what is known while
a term is built is folded away. Terms are built by the C interface of z3: its Python classes take ten times as long.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING, Any, TypeAlias
from weakref import finalize

from rtamt.extras import library

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

#: z3's answers: satisfiable, unsatisfiable, and unknown.
_SATISFIABLE, _UNSATISFIABLE = 1, -1


class Term:
    """An expression of the solver; ``negated``: the term that it is the negation of."""

    __slots__ = ("ast", "key", "negated")

    def __init__(self, ast: Any, negated: Term | None = None) -> None:
        self.ast = ast
        self.key: int = ast.value  # equal expressions are one expression of the solver
        self.negated = negated


Truth: TypeAlias = "bool | Term"
Real: TypeAlias = "Fraction | Term"


@cache
def _core() -> Any:
    return library("z3.z3core", "the analysis of requirements", "analysis")


@cache
def _types() -> Any:
    return library("z3.z3types", "the analysis of requirements", "analysis")


class Solver:
    """Terms and assertions of one context, which is deleted with the object.

    ``limit``: seconds that one query may take.
    """

    def __init__(self, limit: float = 10.0) -> None:
        core = self._core = _core()
        settings = core.Z3_mk_config()
        # Without reference counts: every term lives as long as the context.
        context = self._context = core.Z3_mk_context(settings)
        core.Z3_del_config(settings)
        self._ast = _types().Ast
        self._given = core.Z3_mk_params(context)
        core.Z3_params_inc_ref(context, self._given)
        self._limit = limit
        # Of both of z3's solvers of arithmetic the one that is faster on windows over predicates.
        core.Z3_params_set_uint(context, self._given, self._symbol("arith.solver"), 2)
        self._required: list[Any] = []
        self._model: Any = None
        self._boolean = core.Z3_mk_bool_sort(context)
        self._real = core.Z3_mk_real_sort(context)
        self._numerals: dict[Fraction, Any] = {}
        self._names = 0
        finalize(self, core.Z3_del_context, context)

    # ---- terms -----------------------------------------------------------------------------------

    def _symbol(self, name: str) -> Any:
        return self._core.Z3_mk_string_symbol(self._context, name)

    def _fresh(self, sort: Any) -> Term:
        self._names += 1
        symbol = self._core.Z3_mk_int_symbol(self._context, self._names)
        return Term(self._core.Z3_mk_const(self._context, symbol, sort))

    def truth(self) -> Term:
        """Return a new truth value."""
        return self._fresh(self._boolean)

    def real(self) -> Term:
        """Return a new real number."""
        return self._fresh(self._real)

    def _array(self, terms: Sequence[Term]) -> Any:
        return (self._ast * len(terms))(*[term.ast for term in terms])

    def _numeral(self, number: Real) -> Any:
        if isinstance(number, Term):
            return number.ast
        known = self._numerals.get(number)
        if known is None:
            text = f"{number.numerator}/{number.denominator}"
            known = self._core.Z3_mk_numeral(self._context, text, self._real)
            self._numerals[number] = known
        return known

    def no(self, a: Truth) -> Truth:
        """Return whether ``a`` is false."""
        if isinstance(a, bool):
            return not a
        if a.negated is not None:
            return a.negated
        return Term(self._core.Z3_mk_not(self._context, a.ast), a)

    def every(self, parts: Iterable[Truth]) -> Truth:
        """Return whether all parts are true."""
        return self._join(parts, False, self._core.Z3_mk_and)

    def some(self, parts: Iterable[Truth]) -> Truth:
        """Return whether some part is true."""
        return self._join(parts, True, self._core.Z3_mk_or)

    def _join(self, parts: Iterable[Truth], deciding: bool, make: Any) -> Truth:
        kept: dict[int, Term] = {}
        for part in parts:
            if isinstance(part, bool):
                if part is deciding:
                    return deciding
            else:
                kept[part.key] = part
        if any(part.negated is not None and part.negated.key in kept for part in kept.values()):
            return deciding
        if len(kept) < 2:
            return next(iter(kept.values()), not deciding)
        terms = list(kept.values())
        return Term(make(self._context, len(terms), self._array(terms)))

    def choose(self, condition: Truth, a: Real, b: Real) -> Real:
        """Return the number a where the condition is true, else b."""
        if isinstance(condition, bool):
            return a if condition else b
        if a is b or (isinstance(a, Fraction) and a == b):
            return a
        return Term(self._core.Z3_mk_ite(self._context, condition.ast, self._numeral(a), self._numeral(b)))

    def at_most(self, a: Real, b: Real) -> Truth:
        """Return whether a <= b."""
        if isinstance(a, Fraction) and isinstance(b, Fraction):
            return a <= b
        return Term(self._core.Z3_mk_le(self._context, self._numeral(a), self._numeral(b)))

    def equal(self, a: Real, b: Real) -> Truth:
        """Return whether a = b."""
        return self.every((self.at_most(a, b), self.at_most(b, a)))

    def total(self, parts: Sequence[Real]) -> Real:
        """Return the sum of numbers."""
        constant = sum((part for part in parts if isinstance(part, Fraction)), Fraction(0))
        terms = [part for part in parts if isinstance(part, Term)]
        if not terms:
            return constant
        if constant:
            terms.append(Term(self._numeral(constant)))
        if len(terms) == 1:
            return terms[0]
        return Term(self._core.Z3_mk_add(self._context, len(terms), self._array(terms)))

    def times(self, factor: Fraction, a: Real) -> Real:
        """Return a multiple of a number."""
        if isinstance(a, Fraction):
            return factor * a
        if factor == 1:
            return a
        if factor == 0:
            return factor
        pair = (self._ast * 2)(self._numeral(factor), a.ast)
        return Term(self._core.Z3_mk_mul(self._context, 2, pair))

    def floor(self, a: Real) -> Real:
        """Return the greatest whole number that is not above a number."""
        if isinstance(a, Fraction):
            return Fraction(a.numerator // a.denominator)
        whole = self._core.Z3_mk_real2int(self._context, a.ast)
        return Term(self._core.Z3_mk_int2real(self._context, whole))

    def at_least(self, k: int, parts: Sequence[Truth]) -> Truth:
        """Return whether at least k of the parts are true."""
        sure = sum(1 for part in parts if part is True)
        terms = [part for part in parts if isinstance(part, Term)]
        k -= sure
        if k <= 0 or k > len(terms):
            return k <= 0
        if k in (1, len(terms)):
            return self.some(terms) if k == 1 else self.every(terms)
        return Term(self._core.Z3_mk_atleast(self._context, len(terms), self._array(terms), k))

    # ---- queries ---------------------------------------------------------------------------------

    def require(self, condition: Truth) -> None:
        """Assert a condition in all later queries."""
        if condition is not True:
            self._required.append(self._asserted(condition))

    def _asserted(self, condition: Truth) -> Any:
        return condition.ast if isinstance(condition, Term) else self._core.Z3_mk_false(self._context)

    def ask(self, conditions: Sequence[Truth], limit: float | None = None) -> bool | None:
        """Return whether the conditions can hold together; None if there is no answer within a limit in seconds."""
        return self.asking(conditions)(limit=limit)

    def asking(self, conditions: Sequence[Truth]) -> Asking:
        """Return an incremental query about conditions, to which more can be added."""
        return Asking(self, conditions)

    def conflict(self, conditions: Sequence[Truth]) -> list[int] | None:
        """Return the indices of some conditions that cannot hold together, None if all can or there is no answer."""
        solver, names = self.new(), [self.truth() for _ in conditions]
        self.limited(solver)
        for name, each in zip(names, conditions, strict=True):
            implied = (
                self._core.Z3_mk_implies(
                    self._context, name.ast, each.ast if isinstance(each, Term) else self._asserted(each)
                )
                if each is not True
                else name.ast
            )
            self._core.Z3_solver_assert(self._context, solver, implied)
        if self.answered(solver, names) is not False:
            return None
        found = self._core.Z3_solver_get_unsat_core(self._context, solver)
        size = self._core.Z3_ast_vector_size(self._context, found)
        keys = {self._core.Z3_ast_vector_get(self._context, found, i).value for i in range(size)}
        return [index for index, name in enumerate(names) if name.key in keys]

    def new(self) -> Any:
        """Return a solver with only the conditions of the query: it would have to satisfy any others, too."""
        solver = self._core.Z3_mk_simple_solver(self._context)
        self._core.Z3_solver_inc_ref(self._context, solver)
        for each in self._required:
            self._core.Z3_solver_assert(self._context, solver, each)
        return solver

    def add(self, solver: Any, condition: Truth) -> None:
        """Assert a condition."""
        if condition is not True:
            self._core.Z3_solver_assert(self._context, solver, self._asserted(condition))

    def once(self, solver: Any, condition: Truth) -> bool | None:
        """Return the answer of a solver with one more condition, which it then forgets."""
        self._core.Z3_solver_push(self._context, solver)
        self.add(solver, condition)
        found = self.answered(solver)
        self._core.Z3_solver_pop(self._context, solver, 1)
        return found

    def limited(self, solver: Any, limit: float | None = None) -> None:
        """Set how many seconds the next answer may take."""
        seconds = self._limit if limit is None else min(limit, self._limit)
        self._core.Z3_params_set_uint(
            self._context, self._given, self._symbol("timeout"), max(1, int(seconds * 1000))
        )
        self._core.Z3_solver_set_params(self._context, solver, self._given)

    def answered(self, solver: Any, assumed: Sequence[Term] = ()) -> bool | None:
        """Return the answer of a solver; None on a timeout."""
        answer = self._core.Z3_solver_check_assumptions(
            self._context, solver, len(assumed), self._array(assumed)
        )
        if answer == _SATISFIABLE:
            self._model = self._core.Z3_solver_get_model(self._context, solver)
            self._core.Z3_model_inc_ref(self._context, self._model)
        return None if answer not in (_SATISFIABLE, _UNSATISFIABLE) else answer == _SATISFIABLE

    def is_true(self, a: Truth) -> bool:
        """Return a truth value in the last answer."""
        if isinstance(a, bool):
            return a
        return bool(self._core.Z3_get_bool_value(self._context, self._evaluate(a)) == 1)

    def value(self, a: Real) -> Fraction:
        """Return a number in the last answer."""
        if isinstance(a, Fraction):
            return a
        return Fraction(self._core.Z3_get_numeral_string(self._context, self._evaluate(a)))

    def _evaluate(self, a: Term) -> Any:
        result = (self._ast * 1)()
        self._core.Z3_model_eval(self._context, self._model, a.ast, True, result)
        return result[0]


class Asking:
    """Incremental queries: the solver keeps what it has learned when conditions are added."""

    def __init__(self, solver: Solver, conditions: Sequence[Truth]) -> None:
        self._solver = solver
        self._made = solver.new()
        self.add(conditions)

    def add(self, conditions: Iterable[Truth]) -> None:
        """Add conditions to all later queries."""
        for each in conditions:
            self._solver.add(self._made, each)

    def __call__(self, condition: Truth = True, limit: float | None = None) -> bool | None:
        """Return whether all can hold together, with one more condition; None if there is no answer in time."""
        self._solver.limited(self._made, limit)
        return self._solver.once(self._made, condition)
