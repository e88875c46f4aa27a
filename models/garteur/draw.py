"""The GARTEUR SM-AG19 testbed as one closed surface of bars, in mm: an OFF file.

    draw.py WING_THICKNESS > airplane.off

Dimensions as published (GARTEUR TP-115, 1999); x forward from under the wing, y to the left, z up
from the fuselage's axis. The union of boxes is taken on the grid of all their coordinates.
"""
import sys
from itertools import product

WING_Z = 96.0


def boxes(wing):
    low, high = WING_Z - 5.0, WING_Z - 5.0 + wing
    return [
        ((-900, 600), (-25, 25), (-75, 75)),          # fuselage
        ((-35, 35), (-65, 65), (75, low)),            # plate between fuselage and wing
        ((-50, 50), (-1000, 1000), (low, high)),      # wing
        ((-200, 200), (900, 1000), (high, high + 10)),    # drums on its tips
        ((-200, 200), (-1000, -900), (high, high + 10)),
        ((-900, -800), (-5, 5), (75, 375)),           # fin
        ((-900, -800), (-200, 200), (375, 385)),      # tailplane
    ]


def surface(bodies, largest=50.0):
    """Vertices and quadrilaterals between filled and empty cells of the grid."""
    grid = []
    for axis in range(3):
        ends = sorted({float(end) for box in bodies for end in box[axis]})
        line = [ends[0]]
        for a, b in zip(ends, ends[1:]):
            count = max(1, round((b - a) / largest))
            line += [a + (b - a) * k / count for k in range(1, count + 1)]
        grid.append(line)
    middle = [[0.5 * (a + b) for a, b in zip(line, line[1:])] for line in grid]
    size = [len(line) for line in middle]

    def full(cell):
        if any(not 0 <= c < n for c, n in zip(cell, size)):
            return False
        return any(all(box[k][0] < middle[k][cell[k]] < box[k][1] for k in range(3))
                   for box in bodies)

    numbers, faces = {}, []
    for cell in product(*(range(n) for n in size)):
        if not full(cell):
            continue
        for axis, side in product(range(3), (0, 1)):
            beside = list(cell)
            beside[axis] += 2 * side - 1
            if full(beside):
                continue
            u, v = (axis + 1) % 3, (axis + 2) % 3
            corners = []
            for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                at = list(cell)
                at[axis] += side
                at[u] += a
                at[v] += b
                corners.append(numbers.setdefault(tuple(at), len(numbers)))
            faces.append(corners if side else corners[::-1])
    points = [[grid[k][at[k]] for k in range(3)] for at in numbers]
    return points, faces


def main(wing):
    points, faces = surface(boxes(float(wing)))
    print("OFF")
    print(len(points), 2 * len(faces), 0)
    for point in points:
        print(*(f"{c:g}" for c in point))
    for a, b, c, d in faces:
        print(3, a, b, c)
        print(3, a, c, d)


if __name__ == "__main__":
    main(*sys.argv[1:])
