#!/usr/bin/env python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""random_solids.py PROGRAM COUNT [FIRST]: thickness and offsets of random solids against closed forms.

Plates, boxes, prisms, rods, cones, balls and shells in random poses, the solid's number being the seed, go through
`measure --thickness` and `offset` outward and inward. Each answer must hold the closed form within its printed
interval. Ends with status 1 where fewer than 99 in 100 do; prints each miss with the command that repeats it.

Closed forms: Steiner's formula for the volume of a convex body grown by r, V + A r + M r^2 + 4/3 pi r^3, with M the
half sum over edges of length times turn; what is left of a body r inside is a body of the same kind; and the mean of
local thickness over a convex body is the integral over r of what balls of radius r reach, twice, over the volume.
"""
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile


def turned(angle, axis, p):
    length = math.sqrt(sum(a * a for a in axis))
    x, y, z = (a / length for a in axis)
    c, s = math.cos(angle), math.sin(angle)
    d = x * p[0] + y * p[1] + z * p[2]
    cross = (y * p[2] - z * p[1], z * p[0] - x * p[2], x * p[1] - y * p[0])
    return tuple(c * q + s * w + (1 - c) * d * a for q, w, a in zip(p, cross, (x, y, z)))


def prism(sides, radius, height, tip=False):
    """A regular prism about z whose sides are `radius` from its axis, or a pyramid on that base."""
    corner = radius / math.cos(math.pi / sides)
    ring = [(corner * math.cos(2 * math.pi * i / sides), corner * math.sin(2 * math.pi * i / sides))
            for i in range(sides)]
    points = [(x, y, 0.0) for x, y in ring]
    points += [(0.0, 0.0, height)] if tip else [(x, y, height) for x, y in ring]
    faces = [(0, i + 1, i) for i in range(1, sides - 1)]
    for i in range(sides):
        j = (i + 1) % sides
        faces += [(i, j, sides)] if tip else [(i, j, sides + j), (i, sides + j, sides + i)]
    if not tip:
        faces += [(sides, sides + i, sides + i + 1) for i in range(1, sides - 1)]
    return points, faces


def box(a, b, c):
    points = [(x, y, z) for z in (0, c) for y in (0, b) for x in (0, a)]
    faces = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6),
             (0, 6, 2), (1, 3, 7), (1, 7, 5)]
    return points, faces


def ball(radius, halvings):
    t = (1 + 5**0.5) / 2
    points = [(-1, t, 0), (1, t, 0), (-1, -t, 0), (1, -t, 0), (0, -1, t), (0, 1, t), (0, -1, -t), (0, 1, -t),
              (t, 0, -1), (t, 0, 1), (-t, 0, -1), (-t, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6),
             (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10),
             (8, 6, 7), (9, 8, 1)]

    def on_ball(p):
        length = math.sqrt(sum(q * q for q in p))
        return tuple(radius * q / length for q in p)

    points = [on_ball(p) for p in points]
    for _ in range(halvings):
        middles, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(points)
                points.append(on_ball([p + q for p, q in zip(points[a], points[b])]))
            return middles[key]

        for a, b, c in faces:
            x, y, z = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, x, z), (b, y, x), (c, z, y), (x, y, z)]
        faces = finer
    return points, faces


def steiner(solid):
    """Volume, area, and half the sum of edges' lengths by turns, of a convex solid."""
    points, faces = solid

    def minus(p, q):
        return tuple(a - b for a, b in zip(p, q))

    def cross(p, q):
        return (p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0])

    def dot(p, q):
        return sum(a * b for a, b in zip(p, q))

    volume = area = bend = 0.0
    normals = {}
    for a, b, c in faces:
        across = cross(minus(points[b], points[a]), minus(points[c], points[a]))
        length = math.sqrt(dot(across, across))
        area += 0.5 * length
        volume += dot(points[a], cross(points[b], points[c])) / 6
        normal = tuple(q / length for q in across)
        for edge in ((a, b), (b, c), (c, a)):
            normals[edge] = normal
    for (a, b), normal in normals.items():
        if a > b:
            continue
        side = minus(points[b], points[a])
        other = normals[(b, a)]
        sine = math.sqrt(dot(cross(normal, other), cross(normal, other)))
        bend += 0.5 * math.sqrt(dot(side, side)) * math.atan2(sine, dot(normal, other))
    return volume, area, bend


def grown(solid, r):
    volume, area, bend = steiner(solid)
    return volume + area * r + bend * r * r + 4 / 3 * math.pi * r**3


class Convex:
    """A kind of convex solid; left(r) is what remains r inside, of the same kind, until reach."""

    def __init__(self, left, reach):
        self.left, self.reach = left, reach
        self.solid = left(0.0)

    def offset_mm3(self, by):
        return grown(self.solid, by) if by > 0 else steiner(self.left(-by))[0]

    def mean_thickness_mm(self):
        steps = 200
        total = 0.0
        for i in range(steps):
            r = self.reach * (i + 0.5) / steps
            total += grown(self.left(r), r)
        return 2 * self.reach / steps * total / steiner(self.solid)[0]


class Hollow:
    """A box with a box in it; its mean thickness has no closed form."""

    def __init__(self, outer, wall):
        inner = [side - 2 * wall for side in outer]
        points, faces = box(*outer)
        more, cavity = box(*inner)
        self.solid = (points + [tuple(q + wall for q in p) for p in more],
                      faces + [tuple(i + len(points) for i in reversed(face)) for face in cavity])
        self.outer, self.inner, self.reach = outer, inner, wall / 2

    def offset_mm3(self, by):
        if by > 0:
            left = [side - 2 * by for side in self.inner]
            return grown(box(*self.outer), by) - (math.prod(left) if min(left) > 0 else 0.0)
        return math.prod(side + 2 * by for side in self.outer) - grown(box(*self.inner), -by)

    def mean_thickness_mm(self):
        return None


class Shell(Hollow):
    """A ball with a concentric ball in it."""

    def __init__(self, radius, wall):
        points, faces = ball(radius, 4)
        more, cavity = ball(radius - wall, 4)
        self.solid = (points + more, faces + [tuple(i + len(points) for i in reversed(face)) for face in cavity])
        self.radius, self.wall, self.reach = radius, wall, wall / 2
        # Facets shorten the volume of both balls alike.
        self.share = steiner((points, faces))[0] / (4 / 3 * math.pi * radius**3)

    def offset_mm3(self, by):
        inner = max(self.radius - self.wall - by, 0.0)
        return 4 / 3 * math.pi * ((self.radius + by)**3 - inner**3)

    def mean_thickness_mm(self):
        return self.wall


def random_solid(number):
    pick = random.Random(number)
    u = pick.uniform
    kind = ("plate", "box", "prism", "rod", "cone", "ball", "hollow", "shell")[number % 8]
    if kind in ("plate", "box"):
        sides = [u(20, 60), u(20, 60), u(1.5, 5) if kind == "plate" else u(10, 40)]
        solid = Convex(lambda r: box(*[side - 2 * r for side in sides]), min(sides) / 2)
    elif kind in ("prism", "rod"):
        corners = pick.randint(3, 8) if kind == "prism" else 48
        radius, height = u(5, 20), u(10, 40) if kind == "prism" else u(40, 90)
        solid = Convex(lambda r: prism(corners, radius - r, height - 2 * r), min(radius, height / 2))
    elif kind == "cone":
        corners, radius, height = pick.choice((4, 6, 48)), u(8, 20), u(10, 40)
        reach = radius * height / (radius + math.hypot(radius, height))
        solid = Convex(lambda r: prism(corners, radius * (1 - r / reach), height * (1 - r / reach), True), reach)
    elif kind == "ball":
        radius, halvings = u(5, 20), 4
        solid = Convex(lambda r: ball(radius - r, halvings), radius)
    elif kind == "hollow":
        solid = Hollow([u(25, 50) for _ in range(3)], u(2, 6))
    else:
        solid = Shell(u(10, 25), u(2, 5))
    angle, axis = u(0, math.pi), [pick.gauss(0, 1) for _ in range(3)]
    shift = [u(-50, 50) for _ in range(3)]
    points, faces = solid.solid
    posed = [tuple(q + s for q, s in zip(turned(angle, axis, p), shift)) for p in points], faces
    return kind, solid, posed, u(0.05, 0.5), u(0.1, 0.7)


def answer(program, *arguments):
    done = subprocess.run([program, *arguments, "--json"], capture_output=True, text=True, check=False)
    return json.loads(done.stdout) if done.returncode == 0 else done.stderr.strip().splitlines()[-1]


def main():
    program, count = sys.argv[1], int(sys.argv[2])
    first = int(sys.argv[3]) if len(sys.argv) > 3 else 0
    asked = held = 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        path = str(folder / "solid.off")
        for number in range(first, first + count):
            kind, solid, (points, faces), outward, inward = random_solid(number)
            with open(path, "w", encoding="ascii") as file:
                print("OFF", len(points), len(faces), 0, file=file)
                for p in points:
                    print(*(f"{q:.17g}" for q in p), file=file)
                for face in faces:
                    print(3, *face, file=file)
            cases = [("thickness", solid.mean_thickness_mm(), None)]
            size = solid.reach if not isinstance(solid, Convex) else 4 * solid.reach
            cases.append(("outward", None, outward * size))
            # The facets of a ball do not all touch one ball, so that what is left inside has no closed form.
            if kind != "ball":
                cases.append(("inward", None, -inward * solid.reach))
            for what, truth, by in cases:
                if by is not None:
                    truth = solid.offset_mm3(by)
                    got = answer(program, "offset", path, f"--by={by:.17g}", "-o", str(folder / "moved.off"))
                    value = None if isinstance(got, str) else got["volume"]
                elif truth is not None:
                    got = answer(program, "measure", path, "--thickness")
                    value = None if isinstance(got, str) else got["thickness"]["volume"]["average"]
                else:
                    continue
                asked += 1
                if value and abs(value["value"] - truth) <= value["half_width"]:
                    held += 1
                    print(f"{number} {kind} {what}: {value['value']:.6g} of {truth:.6g}, within "
                          f"{value['half_width']:.3g}", flush=True)
                    continue
                told = f"{value['value']:.6g} +- {value['half_width']:.3g}" if value else got
                print(f"MISS {number} {kind} {what}{'' if by is None else f' by {by:.3g}'}: {told}, truth {truth:.6g}"
                      f": random_solids.py {program} 1 {number}", flush=True)
    print(f"{held} of {asked} answers hold the closed form within the printed interval")
    return 0 if asked > 0 and held >= 0.99 * asked else 1


if __name__ == "__main__":
    sys.exit(main())
