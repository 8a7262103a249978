"""Messages to samples: JSON, Avro and protobuf, and bytes that are none of these."""

import io
import json
import math

import numpy as np
import pytest

import rtamt
from rtamt.scale import protobuf
from rtamt.scale.messages import MessageReader, decode_json, decoder

SPEC = rtamt.parse("always(speed <= 30 and brake.value >= 0)")


def reader(decode=decode_json, spec=SPEC, **options):
    return MessageReader(spec, decode, **options)


def error_of(read, value, key=b"car-1"):
    with pytest.raises(rtamt.TraceError) as caught:
        read.read(value, key)
    return str(caught.value)


def message(**fields):
    return json.dumps({"time": 0, "speed": 1, "brake": {"value": 2}} | fields).encode()


def test_samples_in_json():
    read = reader()
    assert read.read(message(), b"car-1") == ("car-1", 0.0, (1.0, 2.0))
    assert read.read(message(brake={"value": True}, speed="-inf", more=[None]), b"7").values == (
        -math.inf,
        1.0,
    )
    assert reader(key="car").read(message(car="a"), None).key == "a"
    assert reader(key="car").read(message(car=-7), b"car-1").key == "-7"
    assert reader(time="at", unit="ms").read(message(at=1500), b"a").time == 1.5
    assert reader(time="at_ms").read(message(at_ms=1500), b"a").time == 1.5
    assert read.read(message(time="1970-01-01T00:01:00Z"), b"a").time == 60.0
    assert read.read(b'{"stamp": 3, "speed": 1, "brake.value": 2}', b"a") == ("a", 3.0, (1.0, 2.0))


def test_a_number_beyond_the_range_of_a_double_that_nothing_reads():
    assert reader().read(message()[:-1] + b', "more": 1e999}', b"a").values == (1.0, 2.0)


def test_names_units_and_members_of_the_specification():
    spec = rtamt.parse(
        'enum Mode { MANUAL, AUTO = 4 } Mode mode; float v = "vehicle.speed"; always(mode == AUTO -> v <= 30)'
    )
    read = reader(spec=spec)
    found = read.read(b'{"time": 0, "mode": "AUTO", "vehicle": {"speed": 7}}', b"a")
    assert dict(zip(spec.input_names, found.values, strict=True)) == {"mode": 4.0, "v": 7.0}
    assert (
        error_of(read, b'{"time": 0, "mode": "OFF", "vehicle": {"speed": 7}}')
        == "'mode' is \"OFF\", expected a number"
    )


@pytest.mark.parametrize(
    ("value", "error"),
    [
        (None, "the message has no value"),
        (b"", "the message is not JSON: Expecting value at column 1"),
        (b"\xff\xff", "the message is not JSON: it is not UTF-8 text"),
        (b"[1]", 'the message is list, expected a JSON object, such as {"time": 0, "x": 1}'),
        (b"[" * 100_000, "the message is not JSON to read: it is nested too deeply"),
        (b'{"time": ' + b"9" * 10_000 + b"}", "the message is not JSON to read: Exceeds the limit (4300"),
        (b'{"time": NaN}', "the message is not JSON to read: JSON has no number NaN"),
        (b'{"time": 0, "time": 1}', "the message is not JSON to read: a key is given twice"),
        (
            message(time=None),
            "'time' is not a time: expected a number, or a date such as 2026-05-01T12:00:00.5",
        ),
        (
            message(time=True),
            "'time' is not a time: expected a number, or a date such as 2026-05-01T12:00:00.5",
        ),
        (
            message(time=1.7e12),
            "'time' is 1700000000000.0, which is no time in seconds; is its unit another one?",
        ),
        (
            message(time=10**30),
            "'time' is a number beyond 64 bits, which is no time in seconds; is its unit another one?",
        ),
        (
            b'{"speed": 1}',
            "the message has no time: expected a field 'time' or 't' or 'timestamp' or 'stamp' or 'datetime'",
        ),
        (b'{"time": 0, "brake": {"value": 2}}', "the message has no 'speed'"),
        (message(brake=3), "the message has no 'brake.value'"),
        (message(speed=None), "'speed' is null, expected a number"),
        (message(speed="3"), "'speed' is \"3\", expected a number"),
        (message(speed=10**400), "'speed' is beyond the range of a double"),
        (
            b'{"time": 0, "speed": 1e999, "brake": {"value": 2}}',
            "'speed' is beyond the range of a double",
        ),
        (
            b'{"time": 0, "speed": -1e999, "brake": {"value": 2}}',
            "'speed' is beyond the range of a double",
        ),
        (
            b'{"time": 1e999, "speed": 1, "brake": {"value": 2}}',
            "'time' is inf, which is no time in seconds; is its unit another one?",
        ),
        (
            message(time=[1]),
            "'time' is not a time: expected a number, or a date such as 2026-05-01T12:00:00.5",
        ),
        (
            message(time={"sec": 1}),
            "'time' is not a time: expected a number, or a date such as 2026-05-01T12:00:00.5",
        ),
        (message(speed={}), "'speed' is dict, expected a number"),
    ],
)
def test_messages_that_are_no_samples(value, error):
    assert error_of(reader(), value).startswith(error)


def test_keys_that_are_none():
    for key, error in (
        (None, "the message has no key: give it one, or name the field that holds it with --key"),
        (b"\xff", "the key of the message is not UTF-8 text"),
        (b"", 'the key of the message is "", expected 1 to 256 printable characters'),
        (b"a\0", 'the key of the message is "a\\u0000", expected 1 to 256 printable characters'),
        (b"k" * 257, f'the key of the message is "{"k" * 39}..., expected 1 to 256 printable characters'),
    ):
        assert error_of(reader(), message(), key) == error
    read = reader(key="car")
    assert error_of(read, message()) == "the message has no 'car', the field of the key"
    assert error_of(read, message(car=1.5)) == "the key 'car' is 1.5, expected text or an integer"
    assert error_of(read, message(car=10**30)) == "the key 'car' is beyond 64 bits; give it as text"


def test_any_bytes_lead_to_a_sample_or_an_error():
    random = np.random.default_rng(3)
    read, good, errors = reader(), message(), 0
    for _ in range(2000):
        value = bytearray(good)
        for _ in range(3):
            value[random.integers(len(value))] = random.integers(256)
        try:
            read.read(bytes(value), b"a")
        except rtamt.TraceError:
            errors += 1
    assert errors > 1000


def test_in_dense_time_null_is_a_missing_value_as_in_a_stream():
    read = reader(spec=rtamt.parse("x <= 3 and y <= 3", time="dense"))
    x, y = read.read(b'{"time": 1, "x": null, "y": 5}', b"a").values
    assert math.isnan(x)
    assert y == 5.0
    assert error_of(read, b'{"time": 1, "x": null}') == "the message has no 'x' or 'y'"


# ---- Avro ------------------------------------------------------------------------------------------

AVRO = {
    "type": "record",
    "name": "Sample",
    "fields": [
        {"name": "car", "type": "string"},
        {"name": "time", "type": {"type": "long", "logicalType": "timestamp-millis"}},
        {"name": "speed", "type": ["null", "double"]},
        {
            "name": "brake",
            "type": {"type": "record", "name": "Brake", "fields": [{"name": "value", "type": "int"}]},
        },
    ],
}


def avro(tmp_path, schema=AVRO, name="cars.avsc", number=None):
    path = tmp_path / name
    path.write_text(json.dumps(schema))
    return decoder("avro", {number: str(path)})


def avro_bytes(**fields):
    import fastavro

    written = io.BytesIO()
    data = {"car": "a", "time": 1500, "speed": 1.5, "brake": {"value": 2}} | fields
    fastavro.schemaless_writer(written, fastavro.parse_schema(AVRO), data)
    return written.getvalue()


def test_samples_in_avro(tmp_path):
    read = reader(avro(tmp_path), key="car")
    assert read.read(avro_bytes(), None) == ("a", 1.5, (1.5, 2.0))
    assert error_of(read, avro_bytes(speed=None)) == "'speed' is null, expected a number"
    assert (
        error_of(read, avro_bytes() + b"x")
        == "the message is not a record of the schema: 1 bytes follow its end"
    )
    cut = error_of(read, avro_bytes()[:8])
    assert cut.startswith("the message is not a record of the schema: EOFError")
    assert " 0x" not in cut  # an address would make another dead letter of it in each run
    framed = reader(avro(tmp_path, number=7), key="car")
    assert framed.read(b"\0\0\0\0\x07" + avro_bytes(), None).key == "a"
    assert error_of(framed, b"\0\0\0\0\x08" + avro_bytes()) == (
        "the message has the schema ID 8, and schemas are given for 7"
    )
    assert (
        error_of(framed, avro_bytes())
        == "the message does not begin with a schema ID: a byte 0 and four bytes"
    )


def test_any_bytes_of_avro(tmp_path):
    random = np.random.default_rng(3)
    read, good = reader(avro(tmp_path), key="car"), avro_bytes()
    outcomes = set()
    for _ in range(2000):
        value = bytearray(good)
        for _ in range(2):
            value[random.integers(len(value))] = random.integers(256)
        try:
            outcomes.add(type(read.read(bytes(value), None)).__name__)
        except rtamt.TraceError:
            outcomes.add("error")
    assert outcomes == {"Sample", "error"}


def record(type_):
    return {"type": "record", "name": "R", "fields": [{"name": "f", "type": type_}]}


@pytest.mark.parametrize(
    ("schema", "problem"),
    [
        (record(["null", "R"]), "the type 'R' inside itself"),
        (record({"type": "array", "items": "R"}), "the type 'R' inside itself"),
        (record({"type": "array", "items": "null"}), "an array of items without bytes"),
        (
            record({"type": "array", "items": {"type": "record", "name": "E", "fields": []}}),
            "an array of items without bytes",
        ),
        (
            record({"type": "array", "items": {"type": "fixed", "name": "F", "size": 0}}),
            "an array of items without bytes",
        ),
    ],
)
def test_schemas_whose_messages_could_run_without_bound(tmp_path, schema, problem):
    with pytest.raises(rtamt.UsageError) as caught:
        avro(tmp_path, schema)
    assert str(caught.value) == (
        f"the schema '{tmp_path / 'cars.avsc'}' has {problem}, so that a few bytes could make a message of any size; "
        f"messages are not trusted: leave that out of their schema"
    )


def test_schemas_that_are_none(tmp_path):
    path = tmp_path / "cars.avsc"
    for schema, error in (
        ({"type": "record", "name": "R"}, f"'{path}' is not a schema of Avro: "),
        ({"type": "string"}, f"the schema '{path}' is not that of a record"),
    ):
        with pytest.raises(rtamt.UsageError) as caught:
            avro(tmp_path, schema)
        assert str(caught.value).startswith(error)
    path.write_text("{")
    with pytest.raises(rtamt.UsageError, match=r"^the schema '.*' is not JSON$"):
        decoder("avro", {None: str(path)})
    for arguments, error in (
        (("avro", {}), "messages in avro need a schema: name its file"),
        (
            ("json", {None: "x"}),
            "messages in JSON have no schema: leave it out, or choose the format avro or protobuf",
        ),
        (("avro", {None: "x", 1: "y"}), "give either one schema, or schemas with their IDs, as 7=FILE"),
        (("avrò", {}), "the format is 'avrò'; did you mean 'avro'? (formats: avro, json, protobuf)"),
    ):
        with pytest.raises(rtamt.UsageError) as caught:
            decoder(*arguments)
        assert str(caught.value) == error


# ---- protobuf --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def descriptors(tmp_path_factory):
    """Return a file of descriptors, and the class of its message ``cars.Sample``."""
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    field = descriptor_pb2.FieldDescriptorProto
    file = descriptor_pb2.FileDescriptorProto(name="cars.proto", package="cars", syntax="proto3")
    other = file.message_type.add(name="Brake")
    other.field.add(name="value", number=1, type=field.TYPE_INT32, label=field.LABEL_OPTIONAL)
    sample = file.message_type.add(name="Sample")
    for number, (name, type_) in enumerate((("car", field.TYPE_STRING), ("time", field.TYPE_DOUBLE)), 1):
        sample.field.add(name=name, number=number, type=type_, label=field.LABEL_OPTIONAL)
    sample.oneof_decl.add(name="_speed")
    sample.field.add(
        name="speed",
        number=3,
        type=field.TYPE_DOUBLE,
        label=field.LABEL_OPTIONAL,
        oneof_index=0,
        proto3_optional=True,
    )
    sample.field.add(
        name="brake", number=4, type=field.TYPE_MESSAGE, type_name=".cars.Brake", label=field.LABEL_OPTIONAL
    )
    path = tmp_path_factory.mktemp("protobuf") / "cars.desc"
    path.write_bytes(descriptor_pb2.FileDescriptorSet(file=[file]).SerializeToString())
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    return str(path), message_factory.GetMessageClass(pool.FindMessageTypeByName("cars.Sample"))


def test_samples_in_protobuf(descriptors):
    path, sample = descriptors
    value = sample(car="a", time=1.5, speed=3, brake={"value": 0}).SerializeToString()
    read = reader(decoder("protobuf", {None: path}, "cars.Sample"), key="car")
    assert read.read(value, None) == ("a", 1.5, (3.0, 0.0))
    assert (
        error_of(read, sample(car="a", brake={"value": 0}).SerializeToString())
        == "the message has no 'speed'"
    )
    assert error_of(read, sample(car="a", speed=3).SerializeToString()) == "the message has no 'brake.value'"
    assert error_of(read, value[:-1]) == "the message is not a 'cars.Sample'"
    framed = reader(decoder("protobuf", {7: path}, "cars.Sample"), key="car")
    assert framed.read(b"\0\0\0\0\x07\x02\x02" + value, None).key == "a"
    assert error_of(framed, b"\0\0\0\0\x07\x00" + value) == "the message is not of the type 'cars.Sample'"
    assert error_of(framed, b"\0\0\0\0\x07" + b"\xff" * 20) == (
        "the message does not say which type it has: a schema ID is followed by the place of the type"
    )


def test_a_number_of_an_enumeration_without_a_name_is_no_member(tmp_path):
    """Codes of the specification are not those of the schema, in which AUTO is 1."""
    from google.protobuf import descriptor_pb2

    field = descriptor_pb2.FieldDescriptorProto
    file = descriptor_pb2.FileDescriptorProto(name="cars.proto", package="cars", syntax="proto3")
    for number, name in enumerate(("MANUAL", "AUTO")):
        (file.enum_type[0] if number else file.enum_type.add(name="Mode")).value.add(name=name, number=number)
    sample = file.message_type.add(name="Sample")
    sample.field.add(name="time", number=1, type=field.TYPE_DOUBLE, label=field.LABEL_OPTIONAL)
    kind = {"type": field.TYPE_ENUM, "type_name": ".cars.Mode", "label": field.LABEL_OPTIONAL}
    sample.field.add(name="mode", number=2, **kind)
    path = tmp_path / "cars.desc"
    path.write_bytes(descriptor_pb2.FileDescriptorSet(file=[file]).SerializeToString())
    spec = rtamt.parse("enum Mode { MANUAL, AUTO = 4 } Mode mode; always(mode == AUTO)")
    read = reader(decoder("protobuf", {None: str(path)}), spec)
    assert read.read(b"\x10\x01", b"a").values == (4.0,)
    assert error_of(read, b"\x10\x04") == "'mode' is \"4\", expected a number"


@pytest.mark.parametrize("repeated", [False, True])
def test_lists_of_protobuf_are_known_by_every_version(repeated):
    class Old:
        LABEL_REPEATED, label = 3, 3 if repeated else 1

    class New:
        is_repeated = repeated

    assert protobuf._is_repeated(Old()) is repeated
    assert protobuf._is_repeated(New()) is repeated


def test_types_of_protobuf_that_are_none(descriptors, tmp_path):
    path, _ = descriptors
    other = tmp_path / "x"
    other.write_bytes(b"\xff\xff")
    for given, name, error in (
        (path, None, f"the schema '{path}' has several messages: choose one of cars.Brake, cars.Sample"),
        (
            path,
            "cars.Sampel",
            f"the schema '{path}' has no message 'cars.Sampel'; did you mean 'cars.Sample'? "
            "(messages: cars.Sample, cars.Brake)",
        ),
        (
            str(other),
            None,
            f"the schema '{other}' is no file of descriptors: write it with protoc --include_imports "
            f"--descriptor_set_out=FILE",
        ),
    ):
        with pytest.raises(rtamt.UsageError) as caught:
            decoder("protobuf", {None: given}, name)
        assert str(caught.value) == error
