"""Holds docs/scene.schema.json against the reader: for each document of the tables below both give the verdict that
the table says. Needs CAROM_PROGRAM (the program `carom`) and CAROM_SOURCE_DIR."""
import copy
import json
import os
import pathlib
import random
import re
import subprocess
import tempfile
import unittest

import jsonschema

PROGRAM = os.environ["CAROM_PROGRAM"]
ROOT = pathlib.Path(os.environ.get("CAROM_SOURCE_DIR", pathlib.Path(__file__).resolve().parents[2]))
SCHEMA = json.loads((ROOT / "docs/scene.schema.json").read_text(encoding="utf-8"))

DISC = {"disc": {"radius": 0.5}}
BODY = {"shape": DISC, "position": [5, 5]}
WALLS = {"min": [0, 0], "max": [20, 20]}
LATTICE = {"count": [3, 2], "origin": [2, 2], "spacing": [2, 2], "shape": DISC}
GAS = {"count": 50, "radius": 0.5}
STACK = {"count": 3, "origin": [5, 1], "shape": DISC}


def scene(**keys):
    return {"carom": 1, **keys}


def body(**keys):
    return scene(bodies=[{**BODY, **keys}])


def generate(kind, keys, **more):
    return scene(walls=WALLS, generate=[{kind: {**keys, **more}}])


def without(mapping, key):
    return {k: v for k, v in mapping.items() if k != key}


def words_of(schema):
    """Every key and every choice that a schema knows."""
    if isinstance(schema, list):
        return set().union(*map(words_of, schema)) if schema else set()
    if not isinstance(schema, dict):
        return set()
    words = set(schema.get("properties", {})) | {word for word in schema.get("enum", []) if isinstance(word, str)}
    return words.union(*map(words_of, schema.values()))


HOSTILE = [None, True, 0, 1, -1, 0.5, 1e30, -1e30, 2**63, 2**64, "", "NaN", "left", [], {}, [0, 0], [1, 2, 3],
           {"disc": {"radius": 1}}, 67108865, 1025]


def places(document, path=()):
    """The paths of all values of a document, its own aside."""
    members = document.items() if isinstance(document, dict) else enumerate(document)
    for key, value in members:
        yield path + (key,)
        if isinstance(value, (dict, list)):
            yield from places(value, path + (key,))


def mutated(document, choose):
    """The document with one value replaced, taken away, or put under another key."""
    document = copy.deepcopy(document)
    *path, last = choose.choice(list(places(document)))
    parent = document
    for key in path:
        parent = parent[key]
    change = choose.choice(("replace", "replace", "remove", "rename"))
    if change == "replace":
        parent[last] = choose.choice(HOSTILE)
    elif change == "remove" or isinstance(parent, list):
        del parent[last]
    else:
        parent[choose.choice(sorted(words_of(SCHEMA)))] = parent.pop(last)
    return document


def joint(kind, **keys):
    return scene(bodies=[BODY, {**BODY, "name": "arm", "position": [7, 5]}], joints=[{kind: {"a": 0, "b": 1, **keys}}])


VALID = [
    scene(),
    scene(**{"$schema": "scene.schema.json"}),
    {"carom": 1.0},
    scene(name=""),
    scene(name="größer"),
    scene(gravity=[0, -9.81]),
    scene(gravity=[1e7, -1e7]),
    scene(drag={}),
    scene(drag={"linear": 1.5, "angular": 0}),
    scene(walls=WALLS),
    scene(walls={**WALLS, "sides": []}),
    scene(walls={**WALLS, "sides": ["left", "top"]}),
    scene(walls={**WALLS, "material": {"restitution": 0.5}}),
    scene(walls={**WALLS, "material": "rubber"}, materials={"rubber": {}}),
    scene(materials={}),
    scene(materials={"rubber": {"density": 2, "friction": 0, "restitution": 0.8, "rolling_resistance": 0}}),
    scene(materials={"rubber": {"friction": 0.5}}),
    body(material={"rolling_resistance": 0.01}),
    scene(materials={"a/b~c": {}}, default_material="a/b~c"),
    scene(default_material={"restitution": 1}),
    scene(bodies=[]),
    body(),
    scene(bodies=[{"shape": DISC}]),
    body(name="ball", type="dynamic", angle=-1, velocity=[3.5, -0.5], angular_velocity=2, mass=2, color="#E74C3C"),
    body(type="static"),
    body(type="kinematic", velocity=[1, 0], angular_velocity=1),
    body(material={"density": 3}),
    body(fixed_rotation=True),
    body(color=""),
    body(mass=1e-30),
    body(shape={"disc": {"radius": 1e-9}}),
    body(shape={"disc": {"radius": 10000000}}),
    body(type="static", shape={"segment": {"a": [0, 0], "b": [1, 0]}}),
    body(type="static", shape={"chain": {"points": [[0, 0], [1, 0], [2, 1]], "loop": False}}),
    body(type="kinematic", shape={"chain": {"points": [[0, 0], [1, 0], [2, 1]], "loop": True}}, angular_velocity=1),
    scene(generate=[]),
    generate("lattice", LATTICE),
    generate("lattice", without(LATTICE, "shape"), radius_range=[0.1, 0.4]),
    generate("lattice", LATTICE, radius_range=[0.1, 0.4]),
    generate("lattice", without(LATTICE, "origin"), origin=[1, 1], spacing=[0, 0]),
    generate("lattice", LATTICE, jitter=0.1, stagger=True, velocity_rms=1, seed=18446744073709551615),
    generate("lattice", LATTICE, type="static", material={"restitution": 1}, fixed_rotation=True, color="#ffffff"),
    scene(generate=[{"kind": "lattice", **LATTICE}]),
    generate("gas", GAS),
    generate("gas", GAS, velocity_rms=3, seed=7),
    generate("gas", {"count": 50, "radius_range": [0.2, 0.5]}),
    generate("gas", {"count": 50, "shape": DISC}),
    generate("gas", {"count": 50, "shape": DISC, "radius_range": [0.2, 0.5]}),
    scene(walls=WALLS, generate=[{"kind": "gas", **GAS}]),
    generate("stack", STACK),
    generate("stack", STACK, gap=0.1),
    generate("stack", STACK, count=3.0),
    scene(generate=[{"kind": "stack", **STACK}]),
    body(shape={"box": {"width": 1, "height": 2}}),
    body(shape={"capsule": {"length": 1, "radius": 0.2}}),
    body(shape={"polygon": {"vertices": [[0, 0], [1, 0], [0, 1]], "radius": 0.1}}),
    body(shape={"polygon": {"vertices": [[0, 0], [0, 1], [1, 0]]}}, type="static"),
    generate("pyramid", {"base": 5, "origin": [5, 1], "gap": 0, "shape": {"box": {"width": 1, "height": 1}}}),
    generate("stack", {"count": 3, "shape": {"capsule": {"length": 1, "radius": 0.2}}}),
    generate("lattice", {"count": [2, 2], "spacing": [9, 9], "shape": {"box": {"width": 1, "height": 1}}}),
    generate("chain", {"count": 5, "direction": [1, 0], "spacing": 2, "origin": [2, 2], "joint": "revolute", "shape": DISC}),
    generate("chain", {"count": 5, "spacing": 2, "origin": [2, 2], "pinned": False, "shape": DISC}),
    generate("net", {"count": [5, 5], "origin": [1, 1], "spacing": 1, "pinned": "top", "shape": DISC}),
    scene(generate=[{"kind": "net", "count": [5, 5], "spacing": [1, 1], "pinned": "corners", "shape": DISC}]),
    joint("distance", anchor_a=[0, 0], anchor_b=[0, 0], length=1.5, min=0, max=2, frequency=0, damping_ratio=0),
    joint("revolute", a=None, b="arm", anchor=[1, 2], lower=-1, upper=1, motor_speed=3, max_motor_torque=50),
    joint("prismatic", axis=[1, 0], anchor=[0, 0], lower=0, upper=2, motor_speed=1, max_motor_force=10),
    joint("weld", anchor=[0, 0], frequency=0, damping_ratio=0, collide=True),
    joint("wheel", anchor=[0, 0], axis=[0, 1], frequency=4, damping_ratio=0.7, motor_speed=9, max_motor_torque=5),
    joint("gear", a=0, b=1, ratio=-2),
    joint("target", a=None, anchor=[0, 0], target=[1, 1], max_force=100, frequency=5, damping_ratio=0.7),
    joint("revolute", frequency=2, damping_ratio=0.5, break_force=10, break_torque=5),
    body(filter={"group": -3}),
    scene(joints=[]),
    scene(step={}),
    scene(step={"dt": 0.016, "count": 500}),
    scene(step={"count": 0}),
    scene(step={"count": 5e2}),
    scene(step={"dt": 1e-12}),
    scene(step={"dt": 10}),
    scene(accuracy={}),
    scene(accuracy={"solver": "auto", "substeps": 4, "iterations": 1, "precision": "float"}),
    scene(accuracy={"solver": "impulse", "substeps": 1024, "precision": "double"}),
    scene(accuracy={"solver": "pairwise"}),
    scene(accuracy={"solver": "rattle"}),
    scene(effects={}),
    scene(effects={"sleep": False, "continuous": True, "ledger": True}),
    scene(effects={"gravity": False, "drag": True, "rotation": True, "restitution": False}),
    scene(effects={"friction": True, "rolling_resistance": True}),
    scene(effects={"sleep": True}),
    scene(record={"every": 1, "trail": 80}),
    scene(record={}),
]

# Valid for the schema; the reader says that the part is not built yet.
NOT_BUILT_YET = [
    scene(accuracy={"solver": "rigid"}),
]

INVALID = [
    body(type="static", shape={"segment": {"a": [0, 0]}}),
    body(type="static", shape={"segment": {"a": [0, 0], "b": [1, 0], "c": [2, 0]}}),
    body(type="static", shape={"chain": {"points": [[0, 0]]}}),
    body(type="static", shape={"chain": {"points": [[0, 0], [1]]}}),
    body(type="static", shape={"chain": {"points": [[0, 0], [1, 2e8]]}}),
    [], 1, "scene", None, True, {},
    {"carom": 2}, {"carom": "1"}, {"carom": True}, {"carom": None}, {"carom": 1.5},
    scene(gravty=[0, 1]),
    scene(name=1), scene(name=None),
    scene(gravity=-10), scene(gravity=[0]), scene(gravity=[0, 1, 2]), scene(gravity=[0, "NaN"]),
    scene(gravity=[0, None]), scene(gravity=[0, 1.01e7]), scene(gravity={"x": 0, "y": 1}),
    scene(drag=1), scene(drag={"linear": -1}), scene(drag={"quadratic": 1}), scene(drag={"angular": 2e9}),
    scene(walls=[0, 0, 10, 10]), scene(walls={"min": [0, 0]}), scene(walls={"max": [1, 1]}),
    scene(walls={**WALLS, "sides": "left"}), scene(walls={**WALLS, "sides": ["front"]}),
    scene(walls={**WALLS, "sides": ["left", "left"]}), scene(walls={**WALLS, "open": True}),
    scene(walls={**WALLS, "max": [1.1e8, 1]}), scene(walls={**WALLS, "material": 3}),
    scene(materials=[]), scene(materials={"rubber": 1}), scene(materials={"rubber": {"friktion": 0}}),
    scene(materials={"rubber": {"restitution": 1.5}}), scene(materials={"rubber": {"restitution": -0.1}}),
    scene(materials={"rubber": {"density": 0}}), scene(materials={"rubber": {"density": -1}}),
    scene(materials={"rubber": {"density": 1e31}}), scene(materials={"rubber": {"friction": -0.5}}),
    scene(materials={"rubber": {"restitution": "high"}}), scene(default_material=["rubber"]),
    scene(bodies={}), scene(bodies=[1]), scene(bodies=[None]), scene(bodies=[{}]),
    body(shape="disc"), body(shape={}), body(shape={"disc": 0.5}), body(shape={"disc": {}}),
    body(shape={"disc": {"radius": 0}}), body(shape={"disc": {"radius": -0.4}}),
    body(shape={"disc": {"radius": "0.4"}}), body(shape={"disc": {"radius": 1.1e7}}),
    body(shape={"disc": {"radius": 9e-10}}), body(shape={"disc": {"raduis": 0.4}}),
    body(shape={"disc": {"radius": 0.5, "height": 1}}), body(shape={"circle": {"radius": 0.5}}),
    body(shape={"disc": {"radius": 0.5}, "box": {"width": 1, "height": 1}}),
    body(shape={"box": {"width": 1}}), body(shape={"box": {"width": 0, "height": 1}}),
    body(shape={"box": {"width": 1, "height": 1, "radius": 0}}), body(shape={"capsule": {"length": 1}}),
    body(shape={"capsule": {"length": 0, "radius": 1}}), body(shape={"capsule": {"length": 1, "radius": 0}}),
    body(shape={"polygon": {"vertices": [[0, 0], [1, 0]]}}), body(shape={"polygon": {"vertices": [0, 1, 2]}}),
    body(shape={"polygon": {"vertices": [[0, 0], [1, 0], [0, 1.1e7]]}}), body(shape={"polygon": {}}),
    body(shape={"polygon": {"vertices": [[0, 0], [1, 0], [0, 1]], "radius": -0.1}}),
    body(name=7), body(type="moving"), body(type=None), body(position=[1]), body(position=[1, 2, 3]),
    body(position=[1, 1.1e8]), body(position="5 5"), body(angle="90"), body(angle=1.1e8),
    body(velocity=[1.1e7, 0]), body(velocity=3), body(angular_velocity=[1]), body(angular_velocity=-1.1e7),
    body(mass=0), body(mass=-1), body(mass=None), body(mass="heavy"), body(mass=1.1e30),
    body(material=1), body(material={"restitution": 2}), body(fixed_rotation=1), body(fixed_rotation="no"),
    body(color="red"), body(color="#12345"), body(color="#12345g"), body(colour="#123456"),
    scene(generate={}), scene(generate=[1]), scene(generate=[{}]), scene(generate=[{"spiral": {}}]),
    scene(generate=[{"kind": "spiral"}]), scene(generate=[{"kind": 1}]),
    scene(walls=WALLS, generate=[{"lattice": LATTICE, "stack": STACK}]),
    scene(generate=[{"lattice": {"kind": "lattice", **LATTICE}}]),
    generate("lattice", without(LATTICE, "count")), generate("lattice", without(LATTICE, "spacing")),
    generate("lattice", without(LATTICE, "shape")), generate("lattice", LATTICE, count=6),
    generate("lattice", LATTICE, count=[0, 2]), generate("lattice", LATTICE, count=[-3, 2]),
    generate("lattice", LATTICE, count=[3, 2, 1]), generate("lattice", LATTICE, count=[3, 2.5]),
    generate("lattice", LATTICE, count=[1e30, 1]), generate("lattice", LATTICE, count=["3", 2]),
    generate("lattice", LATTICE, spacing=[-1, 1]), generate("lattice", LATTICE, spacing=2),
    generate("lattice", LATTICE, jitter=-0.1), generate("lattice", LATTICE, stagger="yes"),
    generate("lattice", LATTICE, radius_range=0.5), generate("lattice", LATTICE, radius_range=[0.5]),
    generate("lattice", LATTICE, radius_range=[0, 0.5]), generate("lattice", LATTICE, velocity_rms=-1),
    generate("lattice", LATTICE, velocity_rms=1.1e6), generate("lattice", LATTICE, seed=-1),
    generate("lattice", LATTICE, seed=0.5), generate("lattice", LATTICE, seed=18446744073709551616),
    generate("lattice", LATTICE, rows=3), generate("lattice", LATTICE, origin=[0]),
    generate("lattice", LATTICE, name="body"),
    generate("gas", without(GAS, "radius")), generate("gas", without(GAS, "count")),
    generate("gas", GAS, radius=0), generate("gas", GAS, shape=DISC), generate("gas", GAS, radius_range=[0.1, 0.2]),
    generate("gas", GAS, spacing=[1, 1]), generate("gas", GAS, count=0),
    generate("stack", without(STACK, "count")), generate("stack", without(STACK, "shape")),
    generate("stack", STACK, gap=-1), generate("stack", STACK, count=67108865), generate("stack", STACK, seed=1),
    scene(joints={}), scene(joints=[{}]), scene(joints=[{"glue": {}}]), scene(joints=[1]),
    scene(step=0.016), scene(step={"dt": 0}), scene(step={"dt": -0.016}), scene(step={"dt": 11}),
    scene(step={"dt": 1e-13}), scene(step={"count": -1}), scene(step={"count": 1.5}), scene(step={"count": 1e30}),
    scene(step={"steps": 3}), scene(step={"dt": "1/60"}),
    scene(accuracy="high"), scene(accuracy={"solver": "magic"}), scene(accuracy={"solver": 1}),
    scene(accuracy={"substeps": 0}), scene(accuracy={"substeps": 1025}), scene(accuracy={"iterations": -1}),
    scene(accuracy={"substeps": 5000000000}), scene(accuracy={"precision": "half"}), scene(accuracy={"tolerance": 1}),
    scene(effects=["ledger"]), scene(effects={"ledger": 1}), scene(effects={"ledger": None}),
    scene(effects={"wind": True}),
    scene(record={"every": 0}), scene(record={"trail": -1}), scene(record={"every": 1.5}), scene(record={"evry": 1}),
    scene(**{"$schema": 1}),
]

# Valid for the schema, which cannot say how values depend on each other; the reader refuses them.
BEYOND_THE_SCHEMA = [
    scene(walls={"min": [0, 0], "max": [10, 0]}),
    scene(walls={"min": [5, 5], "max": [0, 0]}),
    scene(default_material="rubber"),
    body(material="rubber"),
    scene(bodies=[{**BODY, "name": "a"}, {**BODY, "name": "a"}]),
    scene(walls=WALLS, bodies=[{**BODY, "position": [21, 5]}]),
    scene(walls=WALLS, bodies=[{**BODY, "shape": {"disc": {"radius": 11}}}]),
    body(type="static", velocity=[1, 0]),
    body(type="static", angular_velocity=1),
    body(shape={"segment": {"a": [0, 0], "b": [1, 0]}}),
    body(type="static", shape={"segment": {"a": [1, 0], "b": [1, 0]}}),
    body(type="static", shape={"chain": {"points": [[0, 0], [1, 0]], "loop": True}}),
    body(type="static", shape={"chain": {"points": [[0, 0], [1, 0], [1, 0]]}}),
    generate("stack", {"count": 3, "shape": {"segment": {"a": [0, 0], "b": [1, 0]}}}, type="static"),
    body(fixed_rotation=True, angular_velocity=1),
    body(velocity=[9e6, 9e6]),
    body(shape={"disc": {"radius": 1e-9}}, material={"density": 1e-20}),
    scene(bodies=[{"shape": {"disc": {"radius": 1e-9}}}, {"shape": {"disc": {"radius": 1e7}}}]),
    scene(gravity=[0, -1], effects={"gravity": False}),
    scene(drag={"linear": 1}, effects={"drag": False}),
    scene(bodies=[{**BODY, "angular_velocity": 1}], effects={"rotation": False}),
    scene(default_material={"restitution": 1}, bodies=[BODY], effects={"restitution": False}),
    scene(effects={"continuous": False}),
    scene(generate=[{"gas": GAS}]),
    generate("gas", GAS, count=5000),
    generate("gas", GAS, count=1, velocity_rms=1),
    generate("gas", {"count": 50, "radius_range": [0.5, 0.2]}),
    generate("lattice", LATTICE, count=[67108864, 67108864]),
    generate("lattice", LATTICE, count=[67108864, 1]),
    generate("lattice", LATTICE, type="static", velocity_rms=1),
    generate("lattice", LATTICE, origin=[-5, 0]),
]


class SchemaAgainstReader(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        jsonschema.Draft202012Validator.check_schema(SCHEMA)
        cls.schema = jsonschema.Draft202012Validator(SCHEMA)
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name) / "scene.json"

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def reader_says(self, document):
        """"valid", "invalid" or "not built yet"."""
        self.path.write_text(json.dumps(document), encoding="utf-8")
        run = subprocess.run([PROGRAM, "check", str(self.path)], capture_output=True, text=True, timeout=60)
        self.assertIn(run.returncode, (0, 2), run.stderr)
        if run.returncode == 0:
            return "valid"
        self.assertIn(str(self.path), run.stderr)
        return "not built yet" if "not built yet" in run.stderr else "invalid"

    def check_table(self, table, schema_verdict, reader_verdict):
        for document in table:
            with self.subTest(document=json.dumps(document)):
                self.assertEqual(self.schema.is_valid(document), schema_verdict == "valid", "the schema's verdict")
                self.assertEqual(self.reader_says(document), reader_verdict, "the reader's verdict")

    def test_both_accept_what_is_valid(self):
        self.check_table(VALID, "valid", "valid")

    def test_both_refuse_what_is_invalid(self):
        self.check_table(INVALID, "invalid", "invalid")

    def test_what_is_not_built_yet_is_valid_and_said_to_be_so(self):
        self.check_table(NOT_BUILT_YET, "valid", "not built yet")

    def test_the_reader_refuses_what_a_schema_cannot_express(self):
        self.check_table(BEYOND_THE_SCHEMA, "valid", "invalid")

    def test_the_reader_accepts_no_mutation_that_the_schema_refuses(self):
        choose = random.Random(1)
        for _ in range(150):
            document = mutated(choose.choice(VALID + NOT_BUILT_YET), choose)
            if self.schema.is_valid(document):
                continue
            with self.subTest(document=json.dumps(document)):
                self.assertNotEqual(self.reader_says(document), "valid")

    def test_the_scenes_that_ship_are_valid(self):
        for path in sorted((ROOT / "docs/scenes").glob("*.json")):
            with self.subTest(path=path.name):
                document = json.loads(path.read_text(encoding="utf-8"))
                self.assertEqual([], [error.message for error in self.schema.iter_errors(document)])
                self.assertEqual(self.reader_says(document), "valid")

    def test_the_prose_knows_every_key_and_shows_a_valid_scene(self):
        prose = (ROOT / "docs/scene-format.md").read_text(encoding="utf-8")
        quoted = set(re.findall(r"[`\".]([\w$]+)[`\"]", prose))
        self.assertEqual([], sorted(words_of(SCHEMA) - quoted))
        for example in re.findall(r"```json\n(.*?)```", prose, re.DOTALL):
            self.assertEqual(self.reader_says(json.loads(example)), "valid")


if __name__ == "__main__":
    unittest.main()
