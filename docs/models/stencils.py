#!/usr/bin/env python3
"""Draws the stencils of the bending models: `python3 docs/models/stencils.py` writes docs/models/stencils/*.svg.

A patch of triangles on a gentle dome, seen from the side, grey; on it the unknowns that one element couples. Needs
nothing but Python; the same bytes every time.
"""

from math import cos, hypot, pi, sin
from pathlib import Path

WIDTH, HEIGHT = 720, 400
PANEL = (360.0, 196.0)
GREY, INK, FACE, FACE_2 = "#b8bec6", "#1f2933", "#cfe3f7", "#e7f1fb"
VERTEX, ANGLE, DIRECTOR, POINT, COUPLED = "#0b4f9c", "#d9730d", "#b3261e", "#1e7d45", "#6f9fd0"
ARROW = 0.44


class Patch:
    """A hexagonal patch of triangles with slightly moved vertices; `stretch` makes it anisotropic."""

    def __init__(self, rings=3, stretch=1.0, shear=0.0):
        places = [(i, j) for j in range(-rings, rings + 1) for i in range(-rings, rings + 1) if abs(i + j) <= rings]
        self.ids = {place: n for n, place in enumerate(places)}
        self.plan = []
        for n, (i, j) in enumerate(places):
            # Fixed small shifts, so that no two triangles look alike.
            dx, dy = ((37 * n + 11) % 17 - 8) / 80, ((53 * n + 5) % 13 - 6) / 80
            x, y = i + 0.5 * j + dx, 0.8660254 * j + dy
            self.plan.append((stretch * x + shear * y, y))
        self.faces = []
        for i, j in places:
            for corners in ([(i, j), (i + 1, j), (i, j + 1)], [(i + 1, j), (i + 1, j + 1), (i, j + 1)]):
                if all(c in self.ids for c in corners):
                    self.faces.append(tuple(self.ids[c] for c in corners))

    def at(self, i, j):
        return self.ids[i, j]

    def edges(self):
        return sorted({tuple(sorted((f[c], f[(c + 1) % 3]))) for f in self.faces for c in range(3)})

    def neighbours(self, vertex):
        return sorted({v for f in self.faces if vertex in f for v in f} - {vertex})

    def faces_at(self, edge):
        return [f for f in self.faces if set(edge) <= set(f)]

    def apex(self, face, edge):
        return next(v for v in face if v not in edge)

    def delaunay(self):
        """The same vertices with edges flipped until all angles across an edge sum to at most π."""
        flipped = Patch.__new__(Patch)
        flipped.ids, flipped.plan, flipped.faces = self.ids, self.plan, list(self.faces)
        while True:
            bad = next((e for e in flipped.edges() if flipped.is_bad(e)), None)
            if bad is None:
                return flipped
            a, b = bad
            f0, f1 = flipped.faces_at(bad)
            c, d = flipped.apex(f0, bad), flipped.apex(f1, bad)
            flipped.faces = [f for f in flipped.faces if f not in (f0, f1)] + [(c, d, a), (d, c, b)]

    def is_bad(self, edge):
        faces = self.faces_at(edge)
        if len(faces) < 2:
            return False
        cots = 0.0
        for face in faces:
            (ax, ay), (bx, by), (cx, cy) = (self.plan[v] for v in (*edge, self.apex(face, edge)))
            ux, uy, vx, vy = ax - cx, ay - cy, bx - cx, by - cy
            cots += (ux * vx + uy * vy) / abs(ux * vy - uy * vx)
        return cots < -1e-9


class Picture:
    def __init__(self, patch, zoom=142.0, panel=PANEL, look=(0.0, 0.0)):
        self.patch, self.zoom, self.panel, self.look, self.parts = patch, zoom, panel, look, []

    def lift(self, x, y):
        """A point of the plan on the dome."""
        return x, y, -0.05 * (x * x + y * y)

    def project(self, p):
        x, y, z = p[0] - self.look[0], p[1] - self.look[1], p[2]
        return self.panel[0] + self.zoom * (x + 0.15 * y), self.panel[1] - self.zoom * (0.68 * y + 0.73 * z)

    def vertex(self, v):
        return self.lift(*self.patch.plan[v])

    def middle(self, a, b):
        return tuple((p + q) / 2 for p, q in zip(self.vertex(a), self.vertex(b)))

    def shape(self, points, fill, stroke="none", width=1.0, dash=""):
        path = " ".join("%.1f,%.1f" % self.project(p) for p in points)
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        kind = "polygon" if fill != "none" else "polyline"
        self.parts.append(
            f'<{kind} points="{path}" fill="{fill}" stroke="{stroke}" stroke-width="{width}" stroke-linejoin="round"{dashed}/>'
        )

    def mesh(self):
        for a, b in self.patch.edges():
            self.shape([self.vertex(a), self.vertex(b)], "none", GREY, 1.2)

    def faces(self, faces, fill=FACE, stroke=INK, width=1.8):
        for f in faces:
            self.shape([self.vertex(v) for v in f], fill, stroke, width)

    def edge(self, a, b, colour=INK, width=3.6, dash=""):
        self.shape([self.vertex(a), self.vertex(b)], "none", colour, width, dash)

    def dots(self, vertices, fill=VERTEX, stroke="#ffffff", radius=6.5):
        for v in vertices:
            x, y = self.project(self.vertex(v))
            self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{fill}" stroke="{stroke}" stroke-width="1.6"/>')

    def rings(self, vertices):
        self.dots(vertices, "#ffffff", COUPLED, 5.5)

    def squares(self, edges):
        for a, b in edges:
            x, y = self.project(self.middle(a, b))
            self.parts.append(
                f'<rect x="{x - 6:.1f}" y="{y - 6:.1f}" width="12" height="12" fill="{POINT}" stroke="#ffffff" stroke-width="1.6"/>'
            )

    def arrow(self, start, direction, colour):
        norm = hypot(*direction)
        tip = tuple(s + ARROW * d / norm for s, d in zip(start, direction))
        (x0, y0), (x1, y1) = self.project(start), self.project(tip)
        length = hypot(x1 - x0, y1 - y0)
        ux, uy = (x1 - x0) / length, (y1 - y0) / length
        head = [(x1, y1), (x1 - 11 * ux + 4.5 * uy, y1 - 11 * uy - 4.5 * ux), (x1 - 11 * ux - 4.5 * uy, y1 - 11 * uy + 4.5 * ux)]
        path = " ".join("%.1f,%.1f" % p for p in head)
        self.parts.append(
            f'<line x1="{x0:.1f}" y1="{y0:.1f}" x2="{x1 - 8 * ux:.1f}" y2="{y1 - 8 * uy:.1f}" stroke="{colour}" stroke-width="2.6"/>'
            f'<polygon points="{path}" fill="{colour}"/>'
        )

    def normal(self, p):
        return 0.1 * p[0], 0.1 * p[1], 1.0

    def edge_angles(self, edges):
        """A director at the middle of each edge, with the arc in which its angle turns it about the edge."""
        for a, b in edges:
            m = self.middle(a, b)
            (ax, ay, az), (bx, by, bz) = self.vertex(a), self.vertex(b)
            length = hypot(bx - ax, by - ay, bz - az)
            across = ((by - ay) / length, (ax - bx) / length, 0.0)
            n = self.normal(m)
            arc = [tuple(m[i] + 0.3 * (cos(s) * n[i] + sin(s) * across[i]) for i in range(3))
                   for s in (-0.5 + 1.0 * k / 12 for k in range(13))]
            self.shape(arc, "none", ANGLE, 2.0)
            self.arrow(m, n, ANGLE)
            x, y = self.project(m)
            self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.2" fill="{ANGLE}"/>')

    def directors(self, vertices, colour=DIRECTOR):
        for v in vertices:
            self.arrow(self.vertex(v), self.normal(self.vertex(v)), colour)

    def normals(self, points, colour):
        for p in points:
            self.arrow(p, self.normal(p), colour)


def text(x, y, words, size=15, weight="normal", anchor="start", colour=INK):
    words = words.replace("&", "&amp;").replace("<", "&lt;")
    return (
        f'<text x="{x}" y="{y}" font-family="Helvetica, Arial, DejaVu Sans, sans-serif" font-size="{size}" '
        f'font-weight="{weight}" text-anchor="{anchor}" fill="{colour}">{words}</text>'
    )


MARKS = {
    "vertex": (VERTEX, "position of a vertex"),
    "angle": (ANGLE, "angle of an edge's director"),
    "director": (DIRECTOR, "unit director of a vertex"),
    "point": (POINT, "position of an edge's middle"),
    "coupled": (COUPLED, "coupled in the Hessian"),
    "normal": ("#7a5aa6", "normal, from positions"),
    "flip": (ANGLE, "intrinsic edge"),
}


def legend(kinds):
    out, x = [], 24.0
    for kind in kinds:
        colour, words = MARKS[kind]
        y = HEIGHT - 42
        if kind == "point":
            out.append(f'<rect x="{x}" y="{y - 6}" width="12" height="12" fill="{colour}"/>')
        elif kind == "coupled":
            out.append(f'<circle cx="{x + 6}" cy="{y}" r="5.5" fill="#ffffff" stroke="{colour}" stroke-width="1.6"/>')
        elif kind == "vertex":
            out.append(f'<circle cx="{x + 6}" cy="{y}" r="6" fill="{colour}"/>')
        elif kind == "flip":
            out.append(f'<line x1="{x - 4}" y1="{y}" x2="{x + 14}" y2="{y}" stroke="{colour}" stroke-width="2.6" stroke-dasharray="6 3"/>')
        else:
            out.append(f'<line x1="{x + 6}" y1="{y + 7}" x2="{x + 6}" y2="{y - 3}" stroke="{colour}" stroke-width="2.6"/>')
            out.append(f'<polygon points="{x + 6},{y - 10} {x + 1.5},{y} {x + 10.5},{y}" fill="{colour}"/>')
        out.append(text(x + 20, y + 5, words, 14))
        x += 44 + 7.4 * len(words)
    return out


def write(name, title, pictures, kinds, caption):
    parts = [part for picture in pictures for part in picture.parts]
    svg = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" viewBox="0 0 {WIDTH} {HEIGHT}" role="img">',
        f"<title>Stencil of {name}: {caption.replace('<', '')}</title>",
        f'<rect width="{WIDTH}" height="{HEIGHT}" rx="8" fill="#ffffff"/>',
        f'<clipPath id="view"><rect x="8" y="42" width="{WIDTH - 16}" height="{HEIGHT - 104}"/></clipPath>',
        '<g clip-path="url(#view)">',
        *parts,
        "</g>",
        text(24, 30, title, 18, "bold"),
        *legend(kinds),
        text(24, HEIGHT - 14, caption, 14),
        "</svg>",
        "",
    ]
    folder = Path(__file__).parent / "stencils"
    folder.mkdir(exist_ok=True)
    (folder / f"{name}.svg").write_text("\n".join(svg), encoding="utf-8")


def face_of(patch):
    """A face in the middle with what lies around it: corners, edges, the three neighbours."""
    face = (patch.at(0, 0), patch.at(1, 0), patch.at(0, 1))
    edges = [(face[(c + 1) % 3], face[(c + 2) % 3]) for c in range(3)]
    neighbours = [f for e in edges for f in patch.faces_at(e) if set(f) != set(face)]
    across = [patch.apex(f, e) for f, e in zip(neighbours, edges)]
    return face, edges, neighbours, across


def face_picture(name, title, marks, kinds, caption):
    patch = Patch()
    picture = Picture(patch, look=(0.55, 0.35))
    face, edges, neighbours, across = face_of(patch)
    picture.mesh()
    picture.faces(neighbours, FACE_2, INK, 1.4)
    picture.faces([face])
    marks(picture, face, edges, across)
    write(name, title, [picture], kinds, caption)


def edge_angle_face(name, title):
    def marks(picture, face, edges, across):
        picture.edge_angles(edges)
        picture.dots([*face, *across])

    caption = "An element is a face: 6 vertices and 3 angles, 21 unknowns."
    face_picture(name, title, marks, ["vertex", "angle"], caption)


def position_face(name, title, with_normals):
    def marks(picture, face, edges, across):
        if with_normals:
            picture.normals([picture.middle(*e) for e in edges], MARKS["normal"][0])
        else:
            low, high = picture.middle(*edges[2]), picture.vertex(face[2])
            picture.normals([tuple(0.8 * low[i] + 0.2 * high[i] for i in range(3))], MARKS["normal"][0])
        picture.dots([*face, *across])

    caption = "An element is a face: 6 vertices, 18 unknowns."
    face_picture(name, title, marks, ["vertex", "normal"], caption)


def hinge(name, title, caption="An element is an interior edge with its two faces: 4 vertices, 12 unknowns."):
    patch = Patch()
    picture = Picture(patch, look=(0.5, 0.05))
    edge = (patch.at(0, 0), patch.at(1, 0))
    faces = patch.faces_at(edge)
    picture.mesh()
    picture.faces(faces)
    picture.edge(*edge)
    picture.dots(sorted({v for f in faces for v in f}))
    write(name, title, [picture], ["vertex"], caption)


def vertex_rings(name, title, patch, original=None):
    picture = Picture(original or patch, zoom=82.0)
    centre = patch.at(0, 0)
    ring = patch.neighbours(centre)
    second = sorted({v for r in ring for v in patch.neighbours(r)} - {centre, *ring})
    picture.mesh()
    picture.patch = patch
    star = [f for f in patch.faces if centre in f]
    picture.faces(star, FACE, GREY if original else INK, 1.4)
    kinds = ["vertex", "coupled"]
    if original:
        picture.patch = original
        for a, b in original.edges():
            if original.faces_at((a, b)) and {a, b} <= {centre, *ring}:
                picture.edge(a, b, GREY, 1.6)
        picture.patch = patch
        for a, b in sorted(set(patch.edges()) - set(original.edges())):
            picture.edge(a, b, ANGLE, 2.4, "6 3")
        kinds.append("flip")
    picture.rings(second)
    picture.dots([centre, *ring])
    near = f"{len(ring)} intrinsic neighbours" if original else f"{len(ring)} neighbours"
    caption = f"L + N couples a vertex with {near}, the Hessian with {len(ring) + len(second)}; x, y and z are apart."
    write(name, title, [picture], kinds, caption)


def dkt():
    patch = Patch()
    picture = Picture(patch, look=(0.5, 0.35))
    face, _, _, _ = face_of(patch)
    picture.mesh()
    picture.faces([face])
    picture.directors(face)
    picture.dots(face)
    caption = "An element is a face: 3 vertices and their 3 directors, 18 unknowns."
    write("dkt", "DKT: Discrete Kirchhoff Triangle", [picture], ["vertex", "director"], caption)


def ds_2nd():
    patch = Patch()
    left = Picture(patch, zoom=140.0, panel=(180.0, 196.0), look=(0.45, 0.3))
    right = Picture(patch, zoom=130.0, panel=(540.0, 196.0), look=(0.5, 0.05))
    face, edges, _, _ = face_of(patch)
    window = [(left, 8, 352), (right, 368, 712)]
    left.mesh()
    left.faces([face])
    left.squares(edges)
    left.dots(face)
    edge = (patch.at(0, 0), patch.at(1, 0))
    faces = patch.faces_at(edge)
    right.mesh()
    right.faces(faces)
    right.edge(*edge)
    right.squares(sorted({tuple(sorted((f[c], f[(c + 1) % 3]))) for f in faces for c in range(3)}))
    right.dots(sorted({v for f in faces for v in f}))
    for n, (picture, x0, x1) in enumerate(window):
        clip = f'<clipPath id="half{n}"><rect x="{x0}" y="42" width="{x1 - x0}" height="{HEIGHT - 104}"/></clipPath>'
        picture.parts = [clip, f'<g clip-path="url(#half{n})">', *picture.parts, "</g>"]
    caption = "A face couples 6 nodes, 18 unknowns; an interior edge 9 nodes, 27 unknowns."
    write("ds-2nd", "DS(2nd): Second Order Discrete Shells", [left, right], ["vertex", "point"], caption)


def main():
    edge_angle_face("bac", "BAC: Bending-Active Cosserat")
    edge_angle_face("dcs", "DCS: Discrete Cosserat Shell")
    edge_angle_face("dso", "DSO: Discrete Shape Operator")
    position_face("me-average", "M-e. Av.: averaged mid-edge normals", True)
    position_face("ch-fs", "CH(FS): corotational hinge, faces", False)
    dkt()
    hinge("ds-theta", "DS(θ): Discrete Shells")
    hinge("ds-tan", "DS(tan): Discrete Shells with a barrier")
    hinge("ch-es", "CH(ES): corotational hinge, edges")
    apart = "An element is an interior edge with its two faces: 4 vertices; x, y and z are apart."
    hinge("qb-cr", "QB(CR): Quadratic Bending, Crouzeix–Raviart", apart)
    ds_2nd()
    vertex_rings("qb-pl", "QB(PL): Quadratic Bending, piecewise linear", Patch(rings=4))
    stretched = Patch(rings=4, stretch=0.8, shear=0.55)
    vertex_rings("qb-int", "QB(int): Quadratic Bending, intrinsic Delaunay", stretched.delaunay(), stretched)


if __name__ == "__main__":
    main()
