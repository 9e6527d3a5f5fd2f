"""Delaunay triangulations of points in a plane, with borders forced into them, trimmed to the inside and smoothed.

Points are whole numbers and every decision is exact. So the same points give the same triangles in the same order on
any machine. An outline often has four points on one circle, where rounding would decide.
"""

from collections.abc import Iterable, Sequence

Site = tuple[int, int]
Side = tuple[int, int]
Triangle = tuple[int, int, int]

# Rounds of evening out; each moves what gets better by it, and almost all of the gain comes with the first few.
ROUNDS = 12
# Cotangent of the smallest angle that is good enough to be left alone: 38 degrees.
EVEN = 1.28


class Triangulation:
    """Triangles by their sides: in a counter-clockwise triangle a b c, `apex` of (a, b) is c, of (b, c) is a.

    Built point by point (Lawson 1977) in a frame of three far corners, which `inside` removes.
    """

    def __init__(self, sites: Sequence[Site]) -> None:
        self.sites = list(sites)
        self.apex: dict[Side, int] = {}
        # Of every site the second one of some side that begins with it.
        self._second: dict[int, int] = {}
        self._borders: set[Side] = set()
        count = len(self.sites)
        reach = 1 + max(max(abs(x), abs(y)) for x, y in sites)
        self.sites += [(-64 * reach, -64 * reach), (64 * reach, -64 * reach), (0, 64 * reach)]
        self._add(count, count + 1, count + 2)
        self._last: Side = (count, count + 1)
        for site in range(count):
            self._insert(site)

    # ---- building

    def force(self, a: int, b: int) -> None:
        """Make the line between two sites a side, by flips of sides across it (Sloan 1993). No site may lie on it."""
        crossing = self._crossing(a, b)
        at = 0
        while at < len(crossing):
            side = crossing[at]
            at += 1
            left, right = self.apex[side], self.apex[side[1], side[0]]
            if self.turn(left, right, side[0]) >= 0 or self.turn(left, right, side[1]) <= 0:
                # The four are not convex: later, when what is about them has changed.
                crossing.append(side)
                continue
            self._flip(side)
            ends = {left, right}
            if not ends & {a, b} and self.turn(a, b, left) * self.turn(a, b, right) < 0:
                crossing.append((left, right))

    def inside(self, borders: Iterable[Side]) -> None:
        """Keep only the triangles to the left of closed borders, which are made of sides. Those are never flipped."""
        self._borders = set(borders)
        kept: dict[Side, int] = {}
        waiting = list(self._borders)
        while waiting:
            a, b = waiting.pop()
            if (a, b) in kept:
                continue
            c = self.apex[a, b]
            for side, apex in (((a, b), c), ((b, c), a), ((c, a), b)):
                kept[side] = apex
                if side not in self._borders:
                    waiting.append((side[1], side[0]))
        self.apex = kept
        del self.sites[-3:]

    def even_out(self, fixed: int) -> None:
        """Move each site from the number `fixed` on, if that makes the smallest angle at it larger."""
        self._settle(list(self.apex))
        around = self._stars()
        active = {site for site in range(fixed, len(self.sites)) if self._worst(site, around[site]) > EVEN}
        for _ in range(ROUNDS):
            moved = [site for site in sorted(active) if self._improve(site, around[site])]
            if not moved:
                return
            self._settle([side for site in moved for side in self._sides_about(site, around[site])])
            around = self._stars()
            near = {other for site in moved for other in around[site] if other >= fixed}
            active = {site for site in near | set(moved) if self._worst(site, around[site]) > EVEN}

    # ---- reading

    def triangles(self) -> list[Triangle]:
        """All triangles, each from its lowest site on, in order."""
        return sorted((a, b, c) for (a, b), c in self.apex.items() if a < b and a < c)

    def turn(self, a: int, b: int, c: int) -> int:
        """Twice the signed area of a triangle."""
        (ax, ay), (bx, by), (cx, cy) = self.sites[a], self.sites[b], self.sites[c]
        return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)

    # ---- within

    def _add(self, a: int, b: int, c: int) -> None:
        self.apex[a, b], self.apex[b, c], self.apex[c, a] = c, a, b
        self._second[a], self._second[b], self._second[c] = b, c, a

    def _insert(self, site: int) -> None:
        a, b = self._last
        while True:
            c = self.apex[a, b]
            if self.turn(b, c, site) < 0:
                a, b = c, b
            elif self.turn(c, a, site) < 0:
                a, b = a, c
            elif self.turn(a, b, site) < 0:
                a, b = b, a
            else:
                break
        corners = [a, b, c]
        for k in range(3):
            first, second = corners[k], corners[(k + 1) % 3]
            if self.turn(first, second, site) == 0:
                # On a side: both triangles at it are parted.
                corners.insert(k + 1, self.apex.pop((second, first)))
                self.apex.pop((first, second))
                break
        rim = [(corners[k], corners[(k + 1) % len(corners)]) for k in range(len(corners))]
        for first, second in rim:
            self._add(first, second, site)
        self._settle(rim)
        self._last = site, self._second[site]

    def _settle(self, sides: list[Side]) -> None:
        """Flip sides and their neighbours until no circle around a triangle contains the apex of the next one."""
        while sides:
            a, b = sides.pop()
            left, right = self.apex.get((a, b)), self.apex.get((b, a))
            if left is None or right is None or (a, b) in self._borders or (b, a) in self._borders:
                continue
            if self._in_circle(a, b, left, right):
                self._flip((a, b))
                sides += [(a, right), (right, b), (b, left), (left, a)]

    def _in_circle(self, a: int, b: int, c: int, d: int) -> bool:
        """Whether d lies inside the circle through the corners of a triangle."""
        x, y = self.sites[d]
        ax, ay = self.sites[a][0] - x, self.sites[a][1] - y
        bx, by = self.sites[b][0] - x, self.sites[b][1] - y
        cx, cy = self.sites[c][0] - x, self.sites[c][1] - y
        return (
            (ax * ax + ay * ay) * (bx * cy - by * cx)
            - (bx * bx + by * by) * (ax * cy - ay * cx)
            + (cx * cx + cy * cy) * (ax * by - ay * bx)
        ) > 0

    def _flip(self, side: Side) -> None:
        a, b = side
        left, right = self.apex.pop((a, b)), self.apex.pop((b, a))
        self._add(left, right, b)
        self._add(right, left, a)

    def _crossing(self, a: int, b: int) -> list[Side]:
        """Sides that cross the line from a to b; none if it is a side."""
        if (a, b) in self.apex or (b, a) in self.apex:
            return []
        first = second = self._second[a]
        while not self.turn(a, b, second) < 0 < self.turn(a, b, self.apex[a, second]):
            second = self.apex[a, second]
            if second == first:
                raise ValueError(f"a site lies on the side from {a} to {b}")
        side = (second, self.apex[a, second])
        result = []
        while True:
            result.append(side)
            beyond = self.apex[side[1], side[0]]
            if beyond == b:
                return result
            side = (beyond, side[1]) if self.turn(a, b, beyond) < 0 else (side[0], beyond)

    def _stars(self) -> dict[int, list[int]]:
        """The neighbours of each site, in the order of their numbers."""
        result: dict[int, list[int]] = {}
        for first, second in sorted(self.apex):
            result.setdefault(first, []).append(second)
        return result

    def _sides_about(self, site: int, around: list[int]) -> list[Side]:
        return [side for other in around for side in ((site, other), (other, self.apex[site, other]))]

    def _worst(self, site: int, around: list[int]) -> float:
        """Cotangent of the smallest angle of the triangles at an inner site; infinite if one is turned over."""
        return max(self._sharpest(site, other, self.apex[site, other]) for other in around)

    def _sharpest(self, *corners: int) -> float:
        (ax, ay), (bx, by), (cx, cy) = (self.sites[corner] for corner in corners)
        double = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if double <= 0:
            return float("inf")
        p = (bx - ax) * (cx - ax) + (by - ay) * (cy - ay)
        q = (ax - bx) * (cx - bx) + (ay - by) * (cy - by)
        r = (ax - cx) * (bx - cx) + (ay - cy) * (by - cy)
        return max(p, q, r) / double

    def _improve(self, site: int, around: list[int]) -> bool:
        """Move a site toward the middle of its neighbours if that makes the smallest angle larger."""
        before, (x, y) = self._worst(site, around), self.sites[site]
        # Neighbours weigh as their triangles do, so that many on one side draw no more than few on the other.
        middle_x = sum(self.sites[other][0] for other in around) // len(around)
        middle_y = sum(self.sites[other][1] for other in around) // len(around)
        for part in (1, 2, 4):
            self.sites[site] = x + (middle_x - x) // part, y + (middle_y - y) // part
            if self._worst(site, around) < before:
                return True
        self.sites[site] = x, y
        return False
