"""Pictures and videos that `carom run` draws without a browser, and those of the gallery."""
import math
import os
import re
import shutil
import struct
import subprocess
import unittest
import zlib

import numpy

from program import ALL_FILES, SEED, SOURCE, ProgramTest, gas

# Colours of docs/scenes/seed.json, in body order.
SEED_COLOURS = [(0xE7, 0x4C, 0x3C), (0x2E, 0xCC, 0x71), (0x34, 0x98, 0xDB), (0xF3, 0x9C, 0x12), (0x9B, 0x59, 0xB6)]


def read_png(path):
    """Pixels [height, width, 3] of an 8-bit picture without transparency, by the standard (RFC 2083)."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        assert zlib.crc32(kind + body) == struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
            assert (depth, colour) == (8, 2)
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    rows = numpy.frombuffer(zlib.decompress(packed), numpy.uint8).reshape(height, 1 + 3 * width)
    above, pixels = numpy.zeros(3 * width, int), []
    for kind, row in zip(rows[:, 0], rows[:, 1:].astype(int)):
        if kind == 2:
            row = row + above
        elif kind in (1, 3, 4):
            row = row.copy()
            for i in range(3 * width):
                left, corner = (row[i - 3], above[i - 3]) if i > 2 else (0, 0)
                if kind == 4:
                    guess = left + above[i] - corner
                    guess = min((left, above[i], corner), key=lambda value: abs(guess - value))
                else:
                    guess = left if kind == 1 else (left + above[i]) // 2
                row[i] = (row[i] + guess) % 256
        above = row % 256
        pixels.append(above)
    return numpy.array(pixels).reshape(height, width, 3)


def centres(pixels, colours):
    """Of all pixels of each colour: [colours, (x, y)], and how many there are."""
    found = []
    for colour in colours:
        y, x = numpy.nonzero((pixels == colour).all(axis=2))
        found.append((x.mean() + 0.5, y.mean() + 0.5, len(x)))
    return numpy.array(found)


class PicturesTest(ProgramTest):
    def test_every_frame_is_drawn_and_bodies_are_where_the_trajectory_has_them_to_a_pixel(self):
        results = self.run_scene(SEED, "--steps", 60, "--frames", "pictures")
        frames = results.trajectory()
        names = sorted(path.name for path in (self.folder / "pictures").iterdir())
        self.assertEqual(names, [f"frame-{frame:06}.png" for frame in range(61)])
        scale = None
        for frame in (0, 20, 60):
            drawn = centres(read_png(self.folder / f"pictures/frame-{frame:06}.png"), SEED_COLOURS)
            self.assertGreater(drawn[:, 2].min(), 300)
            world = frames["position"][frame]
            if scale is None:  # the picture is the world, scaled alike both ways and moved
                scale = numpy.polyfit(world[:, 0], drawn[:, 0], 1)[0]
                offset_x, offset_y = (drawn[:, 0] - scale * world[:, 0]).mean(), (drawn[:, 1] + scale * world[:, 1]).mean()
            self.assertLess(numpy.abs(drawn[:, 0] - offset_x - scale * world[:, 0]).max(), 1)
            self.assertLess(numpy.abs(drawn[:, 1] - offset_y + scale * world[:, 1]).max(), 1)
            self.assertLess(numpy.abs(numpy.sqrt(drawn[:, 2] / numpy.pi) - scale * frames["radius"]).max(), 1.5)

    def test_one_picture_shows_the_frame_of_its_time(self):
        self.run_scene(SEED, "--steps", 60, "--frames", "pictures", "--picture", "one.png", "--picture-time", 0.5)
        self.assertEqual((self.folder / "one.png").read_bytes(), (self.folder / "pictures/frame-000031.png").read_bytes())
        self.run_scene(SEED, "--steps", 60, "--picture", "last.png", "--picture-width", 401)
        self.assertEqual(read_png(self.folder / "last.png").shape[1], 400)

    @unittest.skipUnless(shutil.which("ffmpeg"), "ffmpeg is not installed")
    def test_a_second_of_video_is_a_second_of_the_scene(self):
        self.run_scene(SEED, "--steps", 125, "--video", "seed.mp4", "--picture-width", 320)
        probe = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-select_streams", "v:0", "-of", "csv=p=0",
                                "-show_entries", "stream=width,nb_read_frames,avg_frame_rate", "seed.mp4"],
                               cwd=self.folder, capture_output=True, text=True, check=True).stdout.strip()
        self.assertEqual(probe.split(","), ["320", "30/1", "61"])
        self.assertEqual(self.files_in("."), {"out", "seed.mp4"})

    def test_what_cannot_be_drawn_is_refused_before_the_run(self):
        for arguments, message in ((["--frames", "a", "--no-trajectory"], "drawn from the trajectory"),
                                   (["--picture-time", "1"], "--picture-time: there is no --picture"),
                                   (["--picture", "a.png", "--picture-width", "3"], "--picture-width")):
            done = self.carom("run", SEED, "--out", "out", *arguments, expect=2)
            self.assertIn(message, done.stderr)
        done = self.carom("run", SEED, "--out", "out", "--video", "a.mp4", expect=2, env={**os.environ, "PATH": "/nonexistent"})
        self.assertIn("ffmpeg is not installed; --frames", done.stderr)
        self.assertEqual(self.everything(), [])

    def test_a_chain_is_drawn_where_it_stands(self):
        square = {"type": "static", "angle": math.pi / 4, "shape": {"chain": {"points": [[-1, -1], [1, -1], [1, 1], [-1, 1]], "loop": True}}}
        scene = {"carom": 1, "bodies": [square, {"shape": {"disc": {"radius": 0.1}}}]}
        self.run_scene(scene, "--steps", 1, "--no-report", "--picture", "now.png", "--picture-width", 400)
        picture = read_png(self.folder / "now.png")
        self.assertEqual(picture.shape[:2], (400, 400))
        half = 200 / 1.06  # pixels from the middle to a corner of the square, with a margin of 3 % around
        for right, up in ((1, 0), (0, 1), (-1, 0), (0, -1), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)):
            x, y = round(200 + half * right), round(200 - half * up)
            self.assertLess(picture[y - 2:y + 3, x - 2:x + 3].min(), 100, (right, up))
        for right, up in ((0.3, 0.3), (0.8, 0.8), (-0.3, 0.3)):  # inside and outside
            x, y = round(200 + half * right), round(200 - half * up)
            self.assertGreater(picture[y - 2:y + 3, x - 2:x + 3].min(), 200, (right, up))

    def test_a_place_that_cannot_be_written_is_an_error_and_leaves_no_half_picture(self):
        scene = self.write_scene(gas(2, steps=5))
        for arguments in (["--picture", "missing/one.png"], ["--frames", "scene.json/frames"], ["--video", "missing/a.mp4"]):
            if arguments[0] == "--video" and not shutil.which("ffmpeg"):
                continue
            done = self.carom("run", scene, "--out", "out", *arguments, expect=3)
            self.assertIn(arguments[1], done.stderr)
            self.assertNotIn("removed", done.stderr)
            self.assertEqual(self.files_in("out"), ALL_FILES)  # of the run itself
        self.assertEqual([name for name in self.everything() if name.endswith(".part")], [])


class GalleryTest(ProgramTest):
    PAGE = SOURCE / "docs/gallery.md"

    def test_every_scene_has_a_picture_and_a_sentence(self):
        shown = re.findall(r"^\| !\[([\w-]+)\]\(pictures/\1\.png\) \| \*\*\[\1\]\(scenes/\1\.json\)\*\*: \S.*\S \|$",
                           self.PAGE.read_text(), re.MULTILINE)
        scenes = {path.stem for path in (SOURCE / "docs/scenes").glob("*.json")}
        pictures = {path.stem for path in (SOURCE / "docs/pictures").glob("*.png")}
        self.assertEqual((set(shown), len(shown)), (scenes, len(scenes)))
        self.assertEqual(pictures, scenes)
        made = re.findall(r"^picture ([\w-]+) ", (SOURCE / "tools/gallery").read_text(), re.MULTILINE)
        self.assertEqual(set(made), scenes)

    def test_pictures_show_what_their_scenes_do_today(self):
        for name, time, width in re.findall(r"^picture ([\w-]+) ([\d.]+) ?(\d*)$", (SOURCE / "tools/gallery").read_text(), re.MULTILINE):
            if name not in ("seed", "head-on", "rack-break"):
                continue  # the others take long to read in Python
            self.run_scene(SOURCE / f"docs/scenes/{name}.json", "--no-report", "--picture", "now.png", "--picture-time", time,
                           "--picture-width", width or 480)
            kept, now = read_png(SOURCE / f"docs/pictures/{name}.png"), read_png(self.folder / "now.png")
            self.assertEqual(kept.shape, now.shape, name)
            differ = (numpy.abs(kept - now).max(axis=2) > 64).mean()  # another cairo or font smooths edges otherwise
            self.assertLess(differ, 0.005, f"{name}: run tools/gallery")


if __name__ == "__main__":
    unittest.main()
