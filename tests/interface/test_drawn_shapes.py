"""Boxes, capsules and polygons in trajectories, in pictures and in the report's player: drawn turned, where they are."""
import json
import math
import unittest

import h5py
import numpy

from browser import BrowserTest
from program import ProgramTest
from test_pictures import read_png

BOX, CAPSULE, POLYGON = "#e74c3c", "#2ecc71", "#3498db"
COLOURS = [tuple(int(colour[i:i + 2], 16) for i in (1, 3, 5)) for colour in (BOX, CAPSULE, POLYGON)]
# Clockwise, and not around its centroid, which is at (1, 1).
KITE = [[1, 2], [1.5, 1], [1, 0], [0.5, 1]]
LONGEST_MARK = 0.6  # m, of the lines that show how bodies turn
WALLS = {"min": [-3, -2], "max": [3, 2]}
SCENE = {
    "carom": 1, "walls": WALLS, "step": {"dt": 0.1, "count": 3},
    "bodies": [
        {"shape": {"box": {"width": 1.6, "height": 0.5}}, "position": [-1.8, 0.8], "angle": 0.5, "angular_velocity": 1, "color": BOX},
        {"shape": {"capsule": {"length": 1, "radius": 0.3}}, "position": [0.2, -0.9], "angle": -0.4, "color": CAPSULE},
        {"shape": {"polygon": {"vertices": KITE, "radius": 0.2}}, "position": [1.7, 0.3], "angle": 2, "velocity": [-1, 0],
         "color": POLYGON},
        {"shape": {"disc": {"radius": 0.2}}, "position": [-2, -1.5]}]}
OUTLINES = [([[-0.8, -0.25], [0.8, -0.25], [0.8, 0.25], [-0.8, 0.25]], 0), ([[-0.5, 0], [0.5, 0]], 0.3),
            ([[x - 1, y - 1] for x, y in KITE], 0.2)]


def distances(points, vertices, radius):
    """From the boundary of a rounded convex polygon, negative inside: [points]."""
    nearest, inside = numpy.full(len(points), numpy.inf), numpy.ones(len(points), bool)
    middle = numpy.mean(vertices, axis=0)
    for a, b in zip(numpy.array(vertices, float), numpy.roll(numpy.array(vertices, float), -1, axis=0)):
        share = numpy.clip(((points - a) @ (b - a)) / ((b - a) @ (b - a)), 0, 1)[:, None]
        nearest = numpy.minimum(nearest, numpy.linalg.norm(points - a - share * (b - a), axis=1))
        def side(p):
            return (b - a)[0] * (p - a)[..., 1] - (b - a)[1] * (p - a)[..., 0]
        inside &= side(points) * side(middle) > 0
    return numpy.where(inside, -nearest, nearest) - radius


class DrawnShapesTest(ProgramTest, BrowserTest):
    def check_drawn(self, has_colour, centres, frame, scale):
        """has_colour: [bodies, pixels]; centres: of the pixels, in the world."""
        for body, (vertices, radius) in enumerate(OUTLINES):
            place, angle = self.frames["position"][frame, body], self.frames["angle"][frame, body]
            turn = numpy.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
            own = (centres - place) @ turn  # turned back
            distance = scale * distances(own, vertices, radius)
            on_mark = (numpy.abs(own[:, 1]) < 2 / scale) & (own[:, 0] > -2 / scale) & (own[:, 0] < LONGEST_MARK)
            self.assertTrue(has_colour[body][(distance < -2) & ~on_mark].all(), body)
            self.assertFalse(has_colour[body][distance > 1].any(), body)

    def setUp(self):
        super().setUp()
        self.results = self.run_scene(SCENE, "--solver", "soft", "--frames", "pictures")
        self.frames = self.results.trajectory()

    def test_a_trajectory_says_which_outline_each_body_has(self):
        self.assertEqual(list(self.frames["shape"]), [0, 1, 2, -1])
        extents = [math.hypot(0.8, 0.25), 0.8, 1.2, 0.2]
        self.assertTrue(numpy.allclose(self.frames["radius"], extents))
        with h5py.File(self.folder / "out/trajectory.h5", "r") as file:
            shapes = json.loads(file.attrs["settings"])["shapes"]
        for (vertices, radius), shape in zip(OUTLINES, shapes):
            self.assertEqual(shape["radius"], radius)
            order = sorted(map(tuple, numpy.round(shape["vertices"], 12) + 0.0))
            self.assertTrue(numpy.allclose(order, sorted(map(tuple, numpy.array(vertices) + 0.0))))

    def test_pictures_show_every_shape_turned_where_the_trajectory_has_it(self):
        for frame in (0, 3):
            picture = read_png(self.folder / f"pictures/frame-{frame:06}.png")
            height, width = picture.shape[:2]
            scale = min(width / 6, height / 4) / 1.06
            y, x = numpy.mgrid[0:height, 0:width]
            centres = numpy.column_stack([((x + 0.5 - width / 2) / scale).ravel(), ((height / 2 - y - 0.5) / scale).ravel()])
            has_colour = [(picture == colour).all(axis=2).ravel() for colour in COLOURS]
            self.check_drawn(has_colour, centres, frame, scale)

    def test_the_player_shows_every_shape_turned_where_the_trajectory_has_it(self):
        browser = self.open_browser()
        browser.open(self.folder / "out/report.html")
        browser.run('document.getElementById("show-impacts").click()')
        for frame in (0, 3):
            browser.run("carom.player.seekFrame(arguments[0])", frame)
            browser.settle()
            width, height, x0, y0, scale = browser.run(
                "const v = carom.view; return [v.canvas.width, v.canvas.height, v.x(0), v.y(0), v.scale()]")
            pixels = numpy.array(browser.run(
                """const { canvas } = carom.view, copy = document.createElement("canvas"), numbers = [];
                   copy.width = canvas.width;
                   copy.height = canvas.height;
                   const pen = copy.getContext("2d", { willReadFrequently: true });
                   pen.drawImage(canvas, 0, 0);
                   const { data } = pen.getImageData(0, 0, canvas.width, canvas.height);
                   for (let i = 0; i < data.length; i += 4) numbers.push((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
                   return numbers;""")).reshape(height, width)
            y, x = numpy.mgrid[0:height, 0:width]
            centres = numpy.column_stack([((x + 0.5 - x0) / scale).ravel(), ((y0 - y - 0.5) / scale).ravel()])
            has_colour = [(pixels == (r << 16 | g << 8 | b)).ravel() for r, g, b in COLOURS]
            self.check_drawn(has_colour, centres, frame, scale)
        self.assertEqual(browser.console(), [])


if __name__ == "__main__":
    unittest.main()
