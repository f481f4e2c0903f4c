"""carom prices: what it says of which effects, and docs/effects.md, which is made of such results."""
import importlib.machinery
import importlib.util
import json
import re
import unittest

import jsonschema

from program import SOURCE, ProgramTest, gas

SCHEMA = json.loads((SOURCE / "docs/prices.schema.json").read_text())
PAGE = SOURCE / "docs/effects.md"
QUICK = ("--repeats", "2", "--steps", "20")


def keys_of_effects():
    """What scene files can force on or off."""
    return list(json.loads((SOURCE / "docs/scene.schema.json").read_text())["properties"]["effects"]["properties"])


def pile(**more):
    return {
        "carom": 1, "name": "pile", "gravity": [0, -10], "walls": {"min": [0, 0], "max": [8, 20]},
        "default_material": {"friction": 0.5},
        "generate": [{"lattice": {"count": [7, 6], "origin": [0.7, 0.6], "spacing": [1.1, 1.1], "jitter": 0.03,
                                  "shape": {"disc": {"radius": 0.5}}}}],
        "step": {"count": 20}, **more,
    }


class PricesTest(ProgramTest):
    def prices(self, scene, *arguments):
        done = self.carom("prices", self.write_scene(scene), "--json", *QUICK, *arguments)
        result = json.loads(done.stdout)
        jsonschema.validate(result, SCHEMA)
        return result, {effect["name"]: effect for effect in result["effects"]}

    def test_every_effect_that_a_scene_can_force_is_on_the_list(self):
        _, effects = self.prices(pile())
        self.assertLessEqual(set(keys_of_effects()), set(effects))
        self.assertEqual(list(effects), [effect["name"] for effect in self.prices(gas(3))[0]["effects"]])

    def test_both_sides_of_a_price_take_the_same_steps(self):
        for scene in (pile(), gas(5)):
            result, effects = self.prices(scene)
            for name, effect in effects.items():
                if "no_price" not in effect and name != "sleep" and "solver_with" not in effect:
                    self.assertTrue(effect["same_bits"], f"{scene['name']}, {name}")
                    self.assertEqual({len(rounds) for rounds in effect["rounds"].values()}, {2})
            self.assertEqual(result["threads"], 1)
            self.assertEqual(result["clock"], "processor time")

    def test_a_price_follows_from_its_rounds(self):
        result, effects = self.prices(pile())
        for effect in effects.values():
            if "no_price" in effect:
                continue
            pairs = list(zip(effect["rounds"]["without"], effect["rounds"]["with"]))
            self.assertAlmostEqual(effect["share"]["median"], sum(b / a - 1 for a, b in pairs) / 2, places=9)
            self.assertAlmostEqual(effect["ns_per_body_step"]["median"], sum(b - a for a, b in pairs) / 2, places=6)

    def test_what_the_scene_calls_for_is_taken_away_to_be_priced(self):
        _, effects = self.prices(pile())
        self.assertEqual({name for name, effect in effects.items() if effect["called"] and "in_use" in effect},
                         {"gravity", "rotation", "friction", "friction and rotation"})
        self.assertIn("gravity zero", effects["gravity"]["compared"])
        self.assertNotIn("in_use", effects["drag"])

    def test_it_says_what_an_effect_adds(self):
        _, effects = self.prices(pile())
        self.assertEqual(effects["rotation"]["columns"], ["angle", "angular_velocity"])
        self.assertEqual(effects["rotation"]["column_bytes_per_body"], 8)
        self.assertEqual(effects["friction"]["columns"], [])  # on top of rotation
        self.assertIn("solve_contacts", " ".join(effects["friction"]["kernels"]))
        self.assertIn("book_displacements", effects["ledger"]["stages"])
        self.assertGreater(effects["restitution"]["memory_bytes_per_body"], 0)
        _, effects = self.prices(gas(4))
        self.assertEqual(effects["rotation"]["stages"], ["advance_rotation"])

    def test_what_has_no_price_has_a_reason(self):
        _, effects = self.prices(gas(3), "--solver", "impulse")
        self.assertIn("cannot be left out", effects["continuous"]["no_price"])

    def test_an_effect_that_needs_another_solver_is_priced_with_it(self):
        result, effects = self.prices(gas(4, gravity=[0, -1]))
        self.assertEqual(result["solver"], "impulse")
        for name in ("friction", "friction and rotation"):
            self.assertEqual(effects[name]["solver_with"], "soft")
            self.assertIn("solve_contacts", effects[name]["stages"])
        self.assertEqual([name for name, effect in effects.items() if "solver_with" in effect],
                         ["friction", "friction and rotation"])

    def test_an_elastic_gas_without_gravity_carries_friction_under_its_own_solver(self):
        _, effects = self.prices(gas(4))
        for name in ("friction", "friction and rotation"):
            self.assertNotIn("solver_with", effects[name])
            self.assertTrue(effects[name]["same_bits"])

    def test_the_table_and_the_page_have_every_effect(self):
        path = self.write_scene(pile())
        done = self.carom("prices", path, *QUICK, "--out", "prices.json")
        for name in keys_of_effects():
            self.assertRegex(done.stdout, rf"(?m)^  {name} ")
        self.assertIn("in alternation", done.stdout)
        self.carom("report", "prices.json", "--out", "page.html")
        page = (self.folder / "page.html").read_text()
        self.assertIn("What carrying an effect costs", page)
        self.assertIn("angular_velocity", page)

    def test_what_cannot_be_measured_is_refused(self):
        path = self.write_scene(gas(2))
        self.assertIn("pairwise", self.carom("prices", path, "--solver", "pairwise", expect=2).stderr)
        self.assertIn("--repeats", self.carom("prices", path, "--repeats", "0", expect=2).stderr)
        self.assertEqual(self.everything(), ["scene.json"])


class EffectsPageTest(unittest.TestCase):
    def test_the_page_is_what_its_command_makes_of_the_kept_results(self):
        loader = importlib.machinery.SourceFileLoader("make_effects_page", str(SOURCE / "tools/make_effects_page"))
        make = importlib.util.module_from_spec(importlib.util.spec_from_loader("make_effects_page", loader))
        loader.exec_module(make)
        text = PAGE.read_text()
        sources = re.search(r"tools/make_effects_page ((?:\S+\.json ?)+)", text).group(1).split()
        self.assertEqual(len(sources), 3)
        results = [json.loads((SOURCE / source).read_text()) for source in sources]
        for result in results:
            jsonschema.validate(result, SCHEMA)
        self.assertEqual(text, make.page(results, sources))
        for effect in results[0]["effects"]:
            self.assertIn(f"### {effect['name']}\n", text)


if __name__ == "__main__":
    unittest.main()
