"""report.html in a real browser: what it shows equals the result files, it says nothing on the console, loads nothing,
fits a phone, and shows names as text."""
import json
import struct
import unittest
import zlib

import numpy

from browser import Browser
from program import SEED, ProgramTest, Results, gas

# Colours of docs/scenes/seed.json, in body order.
SEED_COLOURS = [(0xE7, 0x4C, 0x3C), (0x2E, 0xCC, 0x71), (0x34, 0x98, 0xDB), (0xF3, 0x9C, 0x12), (0x9B, 0x59, 0xB6)]
PIXELS = """
const canvas = document.getElementById("scene"), copy = document.createElement("canvas");
copy.width = canvas.width;
copy.height = canvas.height;
const pen = copy.getContext("2d", { willReadFrequently: true });
pen.drawImage(canvas, 0, 0);
const {data} = pen.getImageData(0, 0, canvas.width, canvas.height), found = [];
for (const [r, g, b] of arguments[0]) {
    let n = 0, x = 0, y = 0;
    for (let i = 0; i < data.length; i += 4)
        if (data[i] === r && data[i + 1] === g && data[i + 2] === b) {
            n += 1; x += (i / 4) % canvas.width + 0.5; y += Math.floor(i / 4 / canvas.width) + 0.5;
        }
    found.push([n, x / n, y / n]);
}
return found;
"""
# Elements whose text or box goes beyond them or the window, and pairs of controls that overlap.
FLAWS = """
const flaws = [], width = document.documentElement.clientWidth;
if (document.documentElement.scrollWidth > width) flaws.push("the page is wider than the window");
const scrolls = (element) => element.closest(".scroll");
for (const element of document.querySelectorAll("main *")) {
    const box = element.getBoundingClientRect();
    if (!box.width || scrolls(element) || element.matches("script, option")) continue;
    if (box.right > width + 0.5 || box.left < -0.5) flaws.push("beyond the window: " + element.outerHTML.slice(0, 80));
    if (element.scrollWidth > element.clientWidth + 1 && getComputedStyle(element).display !== "inline"
        && !element.matches("input, select")) flaws.push("cut: " + element.outerHTML.slice(0, 80));
}
const boxes = [...document.querySelectorAll("h1, h2, p, figure, table, #scene, .row button, .row select, .row input, output")]
    .filter((element) => element.offsetParent && !scrolls(element) || element.matches(".scroll > table"));
const rects = boxes.map((element) => element.getBoundingClientRect());
boxes.forEach((a, i) => boxes.forEach((b, j) => {
    if (i >= j || a.contains(b) || b.contains(a)) return;
    const p = rects[i], q = rects[j];
    if (p.left < q.right - 1 && q.left < p.right - 1 && p.top < q.bottom - 1 && q.top < p.bottom - 1)
        flaws.push("overlap: " + a.outerHTML.slice(0, 60) + " and " + b.outerHTML.slice(0, 60));
}));
return flaws;
"""


class SeedPageTest(ProgramTest):
    """One run of the seed scene, one window."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)

    def setUp(self):
        super().setUp()
        self.results = self.run_scene(SEED)
        self.browser.open(self.folder / "out/report.html")
        self.browser.settle()
        self.addCleanup(lambda: self.assertEqual(self.browser.console(), []))

    def run_js(self, script, *arguments):
        return self.browser.run(script, *arguments)

    def frame(self):
        return self.run_js("return carom.player.index()")

    def test_bodies_are_drawn_where_the_trajectory_has_them_to_a_pixel(self):
        self.run_js('for (const id of ["show-trails", "show-impacts"]) document.getElementById(id).click()')
        positions, drawn, worst = self.results.trajectory()["position"], [], 0
        frames = range(0, len(positions), 25)
        for frame in frames:
            self.run_js("carom.player.seekFrame(arguments[0])", frame)
            self.browser.settle(2)
            drawn.append(self.run_js(PIXELS, SEED_COLOURS))
        drawn = numpy.array(drawn)
        self.assertTrue((drawn[:, :, 0] > 300).all(), "a body is missing")
        # The picture is the world, scaled alike in both directions and moved: that much is fitted, by the first frame.
        world = positions[::25]
        scale = numpy.polyfit(world[0, :, 0], drawn[0, :, 1], 1)[0]
        offset_x = numpy.mean(drawn[0, :, 1] - scale * world[0, :, 0])
        offset_y = numpy.mean(drawn[0, :, 2] + scale * world[0, :, 1])
        worst = max(numpy.abs(drawn[:, :, 1] - offset_x - scale * world[:, :, 0]).max(),
                    numpy.abs(drawn[:, :, 2] - offset_y + scale * world[:, :, 1]).max())
        self.assertLess(worst, 1)
        radii = numpy.sqrt(drawn[:, :, 0] / numpy.pi) / scale
        self.assertLess(numpy.abs(radii - self.results.trajectory()["radius"]).max(), 1.5 / scale)

    def test_charts_have_the_numbers_of_the_ledger(self):
        ledger = self.results.ledger()
        shown = self.run_js("""
            const data = {};
            for (const [id, chart] of Object.entries(carom.charts))
                data[id] = chart.data.datasets.map((set) => ({ name: set.label, x: set.data.map((p) => p.x), y: set.data.map((p) => p.y) }));
            return data;""")
        def check(chart, name, column):
            [series] = [series for series in shown[chart] if series["name"] == name]
            self.assertEqual(series["x"], list(ledger["time"]))
            self.assertEqual(series["y"], list(ledger[column]))
        for column in ("kinetic", "rotational", "potential", "total"):
            check("energy", column, column)
        check("momentum", "momentum x", "px")
        check("momentum", "momentum y", "py")
        check("angular-momentum", "angular momentum", "L")
        check("wall-impulse", "impulse", "wall_impulse")
        check("unexplained", "unexplained", "unexplained")
        for cause in ("gravity", "drag", "restitution"):  # gains and losses are areas of their own
            parts = [series["y"] for series in shown["causes"] if series["name"] == cause]
            self.assertEqual(list(numpy.sum(parts, axis=0)), list(ledger[cause]), cause)
        stages = self.results.summary["stages"]
        bars = self.run_js("return [carom.charts.stages.data.labels, carom.charts.stages.data.datasets[0].data]")
        self.assertEqual(bars, [[stage["name"] for stage in stages], [1e3 * stage["seconds"] for stage in stages]])

    def test_impacts_are_marked_at_the_steps_in_which_they_were_counted(self):
        ledger = self.results.ledger()
        hit = numpy.diff(ledger["impacts"], prepend=0) > 0
        self.assertEqual(self.run_js("return carom.charts.energy.options.plugins.events.x"), list(ledger["time"][hit]))

    def cursors(self):
        """The time that each chart's line stands at."""
        return self.run_js("""
            return Object.values(carom.charts).filter((chart) => chart.followsTime).map((chart) => {
                const line = chart.canvas.parentElement.querySelector(".time-cursor");
                return line.hidden ? null : chart.scales.x.getValueForPixel(parseFloat(line.style.left));
            });""")

    def test_slider_and_lines_in_charts_show_one_moment_both_ways(self):
        self.run_js('const s = document.getElementById("slider"); s.value = 250; s.dispatchEvent(new Event("input"))')
        self.assertEqual(self.frame(), 250)
        self.assertIn("4.000 s", self.run_js('return document.getElementById("clock").textContent'))
        self.assertEqual(len(self.cursors()), 8)
        for time in self.cursors():
            self.assertAlmostEqual(time, 4, delta=0.02)
        self.press_in_momentum_chart(6.4)
        self.assertAlmostEqual(self.frame(), 400, delta=1)
        self.assertEqual(int(self.run_js('return document.getElementById("slider").value')), self.frame())
        for time in self.cursors():
            self.assertAlmostEqual(time, 6.4, delta=0.04)

    def test_charts_keep_their_lines_and_obey_after_a_change_of_theme(self):
        self.run_js("carom.player.seekFrame(250)")
        colour = self.run_js("return carom.charts.energy.data.datasets[0].borderColor")
        self.browser.set_dark(True)
        self.addCleanup(self.browser.set_dark, False)
        self.browser.settle()
        self.assertNotEqual(self.run_js("return carom.charts.energy.data.datasets[0].borderColor"), colour)
        self.assertEqual(len(self.cursors()), 8)
        for time in self.cursors():
            self.assertAlmostEqual(time, 4, delta=0.02)
        self.press_in_momentum_chart(1.6)
        self.assertAlmostEqual(self.frame(), 100, delta=1)

    def press_in_momentum_chart(self, time):
        self.run_js("""
            const chart = carom.charts.momentum, box = chart.canvas.getBoundingClientRect();
            const at = { clientX: box.left + chart.scales.x.getPixelForValue(arguments[0]), clientY: box.top + 100, bubbles: true };
            for (const type of ["pointerdown", "pointerup"]) chart.canvas.dispatchEvent(new PointerEvent(type, at));""", time)

    def test_it_plays_in_real_time_pauses_and_obeys_the_keyboard(self):
        from selenium.webdriver.common.keys import Keys
        body = self.browser.driver.find_element("tag name", "body")
        body.send_keys(Keys.SPACE)
        ran = self.browser.driver.execute_async_script("""
            const done = arguments[arguments.length - 1], start = performance.now(), first = carom.player.index();
            setTimeout(() => done([carom.player.index() - first, (performance.now() - start) / 1000]), 1500);""")
        self.assertTrue(self.run_js("return carom.player.isPlaying()"))
        self.assertAlmostEqual(ran[0] * 0.016, ran[1], delta=0.4)
        body.send_keys(Keys.SPACE)
        self.assertFalse(self.run_js("return carom.player.isPlaying()"))
        before = self.frame()
        body.send_keys(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT, Keys.ARROW_LEFT)
        self.assertEqual(self.frame(), before + 1)
        body.send_keys(Keys.END)
        self.assertEqual(self.frame(), 500)
        body.send_keys(Keys.HOME)
        self.assertEqual(self.frame(), 0)

    def test_every_control_can_be_reached_by_the_keyboard(self):
        from selenium.webdriver.common.keys import Keys
        reached = set()
        for _ in range(40):
            self.browser.driver.switch_to.active_element.send_keys(Keys.TAB)
            reached.add(self.run_js("return document.activeElement.id"))
        self.assertLessEqual({"scene", "play", "step-back", "step-on", "slider", "speed", "show-trails", "trail-length",
                              "show-arrows", "show-impacts", "zoom-in", "zoom-out", "fit"}, reached)

    def click_at(self, x, y):
        """Clicks into the world at that place."""
        self.run_js("""
            const view = carom.view, box = view.canvas.getBoundingClientRect(), sharp = view.sharpness();
            const at = { clientX: box.left + 1 + view.x(arguments[0]) / sharp, clientY: box.top + 1 + view.y(arguments[1]) / sharp,
                         pointerId: 1, bubbles: true };
            view.canvas.setPointerCapture = () => {};
            for (const type of ["pointerdown", "pointerup"]) view.canvas.dispatchEvent(new PointerEvent(type, at));""", x, y)
        return self.run_js('const card = document.getElementById("body-card"); return card.hidden ? "" : card.innerText')

    def test_a_click_on_a_body_shows_its_numbers_and_beside_it_nothing(self):
        frame = 100
        self.run_js("carom.player.seekFrame(arguments[0])", frame)
        trajectory = self.results.trajectory()
        for body in range(5):
            x, y = map(float, trajectory["position"][frame, body])
            text = self.click_at(x, y)
            self.assertIn(f"Body {body}", text)
            numbers = {name: float(value.split()[0]) for name, value in zip(text.split("\n")[1::2], text.split("\n")[2::2])}
            self.assertAlmostEqual(numbers["x"], x, delta=1e-3)
            self.assertAlmostEqual(numbers["velocity y"], float(trajectory["velocity"][frame, body, 1]), delta=1e-3)
            self.assertAlmostEqual(numbers["mass"], trajectory["mass"][body], delta=1e-3)
        self.assertEqual(self.click_at(0.3, 0.3), "")

    def test_zooming_keeps_what_is_drawn_at_its_place_in_the_world(self):
        self.run_js('for (const id of ["show-trails", "show-impacts"]) document.getElementById(id).click()')
        self.run_js("carom.view.zoom(1.6, 300, 300); carom.view.pan(20, -30); carom.player.redraw()")
        self.browser.settle()
        x, y = map(float, self.results.trajectory()["position"][0, 3])
        _, drawn_x, drawn_y = self.run_js(PIXELS, [SEED_COLOURS[3]])[0]
        self.assertAlmostEqual(drawn_x, self.run_js("return carom.view.x(arguments[0])", x), delta=1)
        self.assertAlmostEqual(drawn_y, self.run_js("return carom.view.y(arguments[0])", y), delta=1)

    def test_a_heading_sorts_the_table_of_bodies_by_numbers(self):
        column = lambda: [float(cell) for cell in self.run_js(
            'return [...document.querySelectorAll("table.sortable td:nth-child(2)")].map((cell) => cell.textContent)')]
        expected = [round(float(row["x"]), 2) for row in self.results.final]
        self.assertEqual(column(), expected)
        button = 'document.querySelectorAll("table.sortable th button")[1].click()'
        self.run_js(button)
        self.assertEqual(column(), sorted(expected))
        self.run_js(button)
        self.assertEqual(column(), sorted(expected, reverse=True))

    def test_nothing_is_loaded_but_the_file_itself(self):
        requests = [json.loads(entry["message"])["message"] for entry in self.browser.driver.get_log("performance")]
        page = (self.folder / "out/report.html").as_uri()
        urls = {entry["params"]["request"]["url"] for entry in requests if entry["method"] == "Network.requestWillBeSent"
                and entry["params"]["documentURL"] == page}
        self.assertEqual(urls, {page})


PIXELS_AT = """
const [places, frame] = arguments, canvas = document.getElementById("scene"), copy = document.createElement("canvas");
copy.width = canvas.width;
copy.height = canvas.height;
const pen = copy.getContext("2d", { willReadFrequently: true });
pen.drawImage(canvas, 0, 0);
const { data } = pen.getImageData(0, 0, copy.width, copy.height);
return places.map(([x, y]) => {
    const at = 4 * (Math.floor(carom.view.y(y)) * copy.width + Math.floor(carom.view.x(x)));
    return [...data.slice(at, at + 3)];
});
"""


class MarksTest(ProgramTest):
    """What is drawn beside few bodies, and how very many are drawn."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)

    def open_scene(self, scene, *arguments):
        results = self.run_scene(scene, *arguments)
        self.browser.open(self.folder / "out/report.html")
        self.browser.settle()
        self.addCleanup(lambda: self.assertEqual(self.browser.console(), []))
        return results.trajectory()

    def pixels_at(self, places):
        return [tuple(pixel) for pixel in self.browser.run(PIXELS_AT, [list(map(float, place)) for place in places])]

    def show(self, frame, *toggled):
        for name in toggled:
            self.browser.run("document.getElementById(arguments[0]).click()", name)
        self.browser.run("carom.player.seekFrame(arguments[0])", frame)
        self.browser.settle(2)

    def test_every_one_of_very_many_discs_is_drawn_at_its_place_and_in_its_size(self):
        side = 45  # 2,025 discs: beyond those that are drawn as paths
        trajectory = self.open_scene(gas(side, steps=60, every=20))
        self.show(3, "show-impacts")
        disc = tuple(int(self.browser.run("return carom.theme.colour(0)")[i:i + 2], 16) for i in (1, 3, 5))
        self.assertEqual(set(self.pixels_at(trajectory["position"][3])), {disc})
        scale = self.browser.run("return carom.view.scale()")
        self.assertLess(0.5 * scale, 8)  # pixels: small enough to be set one by one
        (full, _, _), = self.browser.run(PIXELS, [disc])
        area = side * side * numpy.pi * (0.5 * scale) ** 2
        rim = side * side * numpy.pi * scale
        self.assertAlmostEqual(full, area - 0.5 * rim, delta=0.25 * rim)  # pixels on the rim are of mixed colour

    def test_a_flash_shows_where_two_bodies_met_and_when(self):
        trajectory = self.open_scene(SEED.parent / "head-on.json")
        velocity = trajectory["velocity"][:, 0, 0]
        hit = int(numpy.argmax(velocity < 0))  # the first frame after
        flash = (0xD0, 0, 0)
        self.show(hit - 1)
        self.assertEqual(self.browser.run(PIXELS, [flash])[0][0], 0)
        self.show(hit)
        count, x, y = self.browser.run(PIXELS, [flash])[0]
        self.assertGreater(count, 20)
        self.assertAlmostEqual(x, self.browser.run("return carom.view.x(0)"), delta=2)
        self.assertAlmostEqual(y, self.browser.run("return carom.view.y(0)"), delta=2)

    def test_rotation_marks_and_velocity_arrows_point_where_the_trajectory_says(self):
        scene = {"carom": 1, "name": "spin", "walls": {"min": [0, 0], "max": [10, 6]},
                 "bodies": [{"shape": {"disc": {"radius": 1}}, "position": [2, 2], "angular_velocity": 2, "velocity": [1, 0.5]},
                            {"shape": {"disc": {"radius": 1}}, "position": [7, 4], "angular_velocity": -1, "velocity": [-1, -0.8]}],
                 "step": {"dt": 0.01, "count": 100}}
        trajectory = self.open_scene(scene)
        frame = 70
        position, velocity, angle = (trajectory[name][frame] for name in ("position", "velocity", "angle"))
        along = numpy.stack([numpy.cos(angle), numpy.sin(angle)], axis=1)
        self.show(frame)
        light, dark = (lambda pixel: min(pixel) > 180), (lambda pixel: max(pixel) < 90)  # the lines' edges are smooth
        self.assertTrue(all(map(light, self.pixels_at(position + 0.6 * along))))
        self.assertFalse(any(map(light, self.pixels_at(position - 0.6 * along))))
        self.show(frame, "show-marks", "show-arrows")
        self.assertFalse(any(map(light, self.pixels_at(position + 0.6 * along))))
        ahead = numpy.array(velocity) / numpy.linalg.norm(velocity, axis=1)[:, None]
        found = [self.pixels_at(position + sign * 0.05 * ahead) for sign in (1, -1)]
        self.assertTrue(all(map(dark, found[0])), found)
        self.assertFalse(any(map(dark, found[1])), found)


class LooksTest(ProgramTest):
    """No overlap, no cut text, and colours that stand out, wide and narrow, light and dark."""

    def contrast(self, browser):
        """Of text against ground, by the formula of WCAG 2.1."""
        def luminance(colour):
            channels = [int(colour[i:i + 2], 16) / 255 for i in (1, 3, 5)]
            linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
            return sum(weight * c for weight, c in zip((0.2126, 0.7152, 0.0722), linear))
        named = lambda name: browser.run("return carom.theme.named(arguments[0])", name)
        grounds = [luminance(named(name)) for name in ("--ground", "--panel")]
        def against(colour):
            return min((max(luminance(colour), ground) + 0.05) / (min(luminance(colour), ground) + 0.05) for ground in grounds)
        return (min(against(named(name)) for name in ("--text", "--faint", "--accent")),
                min(against(colour) for colour in browser.run("return carom.theme.palette()")))

    def test_page_fits_the_window(self):
        scene = json.loads(SEED.read_text())
        scene["name"] = "a rather long name of a scene, as people give them: " + "x" * 60
        scene["bodies"][0]["name"] = "y" * 80
        scene["bodies"][0]["angular_velocity"] = 2
        self.run_scene(scene)
        for width, height, scale in ((390, 844, 2), (1280, 900, 1)):
            browser = Browser(width=width, height=height, scale=scale)
            try:
                browser.open(self.folder / "out/report.html")
                for dark in (False, True):
                    browser.set_dark(dark)
                    browser.run("carom.player.seekFrame(100)")
                    browser.settle()
                    with self.subTest(width=width, dark=dark):
                        self.assertEqual(browser.run(FLAWS), [])
                        self.assertEqual(browser.run("return carom.theme.isDark()"), dark)
                        words, lines = self.contrast(browser)
                        self.assertGreater(words, 4.5)
                        self.assertGreater(lines, 3)
                self.assertEqual(browser.console(), [])
            finally:
                browser.close()


class HostileNamesTest(ProgramTest):
    def test_markup_in_names_is_shown_as_text_and_never_run(self):
        bad = ['<img src=x onerror="window.ran=1">', "</script><script>window.ran=1</script>", "<!--<script>", "\u2028]]>'\"&amp;"]
        scene = gas(2, name=bad[0] + bad[1], steps=5)
        for body, name in zip(scene["bodies"], bad):
            body["name"] = name
        self.run_scene(scene)
        browser = Browser()
        self.addCleanup(browser.close)
        browser.open(self.folder / "out/report.html")
        browser.settle()
        self.assertEqual(browser.run("return document.title"), bad[0] + bad[1])
        self.assertEqual(browser.run('return document.querySelector("h1").textContent'), bad[0] + bad[1])
        shown = browser.run('return [...document.querySelectorAll("table.sortable td:nth-child(2)")].map((cell) => cell.textContent)')
        self.assertEqual(shown, bad)
        cards = [browser.run("carom.painter.wishes.chosen = arguments[0]; carom.bodyCard.show(0);"
                             'return document.querySelector("#body-card strong").textContent', body) for body in range(4)]
        self.assertEqual(cards, [f"Body {body}: {name}" for body, name in enumerate(bad)])
        self.assertIsNone(browser.run("return window.ran || null"))
        self.assertEqual(browser.run('return document.querySelectorAll("img").length'), 0)
        self.assertEqual(browser.console(), [])


class LeftOutTest(ProgramTest):
    """The page says what it does not have."""

    def page_text(self, *arguments, expect=0, scene=None):
        self.run_scene(scene or gas(3, steps=30), *arguments, expect=expect)
        browser = Browser()
        try:
            browser.open(self.folder / "out/report.html")
            browser.settle()
            self.assertEqual(browser.console(), [])
            return browser.run('return document.querySelector("main").innerText'), browser.run("return carom.frames && carom.frames.count")
        finally:
            browser.close()

    def test_without_trajectory_or_ledger_the_rest_is_there(self):
        text, frames = self.page_text("--no-trajectory", "--effects", "-ledger")
        self.assertIsNone(frames)
        self.assertIn("recorded no trajectory", text)
        self.assertIn("kept no ledger", text)
        self.assertIn("Time by stage", text)

    def test_a_run_of_no_steps_shows_the_start(self):
        text, frames = self.page_text("--steps", 0)
        self.assertEqual(frames, 1)

    def test_warnings_stand_at_the_top_in_words(self):
        scene = gas(2, steps=10)
        del scene["walls"]
        scene["bodies"][0].update(position=[9.9e7, 0], velocity=[9e6, 0])
        text, _ = self.page_text(scene=scene, expect=1)
        self.assertRegex(text.split("\n\n")[1], "^1 of 4 bodies were disabled")

    def test_a_page_of_one_megabyte_thins_its_frames_and_says_so(self):
        text, frames = self.page_text("--page-size", 1, scene=gas(30, steps=200))
        self.assertLess((self.folder / "out/report.html").stat().st_size, 1.7e6)
        self.assertLess(frames, 201)
        self.assertIn(f"The player has {frames} of 201 frames", text)
        self.assertIn("Velocities are left out", text)


if __name__ == "__main__":
    unittest.main()
