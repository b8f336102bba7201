"""The room with a window that tools/compare_cycles bakes beside its real levels, and the sky outside of it.

                x = 6 +-----------------------------+
                      |  +------+        +---+      |
      window, 4 x 1.8 |  |table |        |   |      |     6 x 3 x 8 m inside, y up, the sill 0.8 m above the floor.
      m, in a wall of =  +------+        |bed|      |     Light comes from the sky through the window, straight or
      0.2 m at z = 0  |                  |   |      |     off room and furniture; whatever of the sky lies below the
                      |      +--------+  +---+      |     horizon is ground.
                      |      |cupboard|             |
                x = 0 +------+--------+-------------+ z = 8

Walls have their inner face alone, so that no texel lies in the open."""
import json
import math
import struct

WIDTH, HEIGHT, LENGTH, WALL = 6.0, 3.0, 8.0, 0.2
WINDOW = (1.0, 0.8, 5.0, 2.6)  # x and y from, x and y to
COLORS = {'wall': (0.76, 0.73, 0.68), 'floor': (0.45, 0.31, 0.19), 'ceiling': (0.82, 0.82, 0.82),
          'cupboard': (0.5, 0.19, 0.14), 'table': (0.6, 0.47, 0.3), 'bed': (0.16, 0.25, 0.5)}
SKY_SIZE = (128, 64)
ZENITH, GROUND = (8.0, 9.0, 11.0), (1.0, 0.9, 0.75)


def box(low, high, without=''):
    """The faces of a box that look outward, but those named in `without` by their axis, a capital for the far side."""
    (a, b, c), (d, e, f) = low, high
    faces = {'x': [(a, b, c), (a, b, f), (a, e, f), (a, e, c)], 'X': [(d, b, f), (d, b, c), (d, e, c), (d, e, f)],
             'y': [(a, b, c), (d, b, c), (d, b, f), (a, b, f)], 'Y': [(a, e, f), (d, e, f), (d, e, c), (a, e, c)],
             'z': [(d, b, c), (a, b, c), (a, e, c), (d, e, c)], 'Z': [(a, b, f), (d, b, f), (d, e, f), (a, e, f)]}
    return [corners for side, corners in faces.items() if side not in without]


def inward(faces):
    return [corners[::-1] for corners in faces]


def window_wall():
    """Around the window at z = 0: the wall as a ring of four pieces, and the reveal out to the wall's far side."""
    x0, y0, x1, y1 = WINDOW
    outer = [(0, 0, 0), (WIDTH, 0, 0), (WIDTH, HEIGHT, 0), (0, HEIGHT, 0)]
    inner = [(x0, y0, 0), (x1, y0, 0), (x1, y1, 0), (x0, y1, 0)]
    ring = [[outer[i], outer[(i + 1) % 4], inner[(i + 1) % 4], inner[i]] for i in range(4)]
    return ring + inward(box((x0, y0, -WALL), (x1, y1, 0), 'zZ'))


def room_objects():
    """Name, and for each material its quadrilaterals, counter-clockwise from the front."""
    hull_low, hull_high = (0, 0, 0), (WIDTH, HEIGHT, LENGTH)
    table = box((4.1, 0.7, 1.2), (5.6, 0.75, 2.4))
    for x, z in ((4.15, 1.25), (5.47, 1.25), (4.15, 2.27), (5.47, 2.27)):
        table += box((x, 0, z), (x + 0.08, 0.7, z + 0.08), 'yY')
    return [('room', {'floor': inward(box(hull_low, hull_high, 'xXYzZ')),
                      'ceiling': inward(box(hull_low, hull_high, 'xXyzZ')),
                      'wall': inward(box(hull_low, hull_high, 'yYz')) + window_wall()}),
            ('table', {'table': table}),
            ('cupboard', {'cupboard': box((0, 0, 2.5), (0.6, 2.1, 4.5), 'xy')}),
            ('bed', {'bed': box((1.9, 0, 5.3), (3.9, 0.5, 6.4), 'y')})]


def normal_of(corners):
    a, b, c = corners[:3]
    u, v = [b[i] - a[i] for i in range(3)], [c[i] - a[i] for i in range(3)]
    n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    length = math.sqrt(sum(x * x for x in n))
    return [x / length for x in n]


def room_make():
    """The room as the parts of a .glb: its document, and the chunk of its buffer. It leaves layouts to the baker."""
    level = {'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': []}], 'nodes': [], 'meshes': [],
             'materials': [], 'accessors': [], 'bufferViews': []}
    data = bytearray()

    def accessor_add(packed, kind, component, count, **more):
        level['bufferViews'].append({'buffer': 0, 'byteOffset': len(data), 'byteLength': len(packed)})
        level['accessors'].append(dict({'bufferView': len(level['bufferViews']) - 1, 'componentType': component,
                                        'type': kind, 'count': count}, **more))
        data.extend(packed)
        return len(level['accessors']) - 1

    names = list(COLORS)
    for name in names:
        level['materials'].append({'name': name, 'pbrMetallicRoughness': {
            'baseColorFactor': list(COLORS[name]) + [1], 'metallicFactor': 0, 'roughnessFactor': 1}})
    for name, parts in room_objects():
        primitives = []
        for material, faces in parts.items():
            points = [corner for corners in faces for corner in corners]
            normals = [n for corners in faces for n in 4 * [normal_of(corners)]]
            indices = [4 * k + i for k in range(len(faces)) for i in (0, 1, 2, 0, 2, 3)]
            primitives.append({'material': names.index(material), 'attributes': {
                'POSITION': accessor_add(b''.join(struct.pack('<3f', *p) for p in points), 'VEC3', 5126, len(points),
                                         min=[min(p[i] for p in points) for i in range(3)],
                                         max=[max(p[i] for p in points) for i in range(3)]),
                'NORMAL': accessor_add(b''.join(struct.pack('<3f', *n) for n in normals), 'VEC3', 5126, len(normals))},
                'indices': accessor_add(struct.pack('<%dI' % len(indices), *indices), 'SCALAR', 5125, len(indices))})
        level['scenes'][0]['nodes'].append(len(level['nodes']))
        level['nodes'].append({'name': name, 'mesh': len(level['meshes'])})
        level['meshes'].append({'name': name, 'primitives': primitives})
    level['buffers'] = [{'byteLength': len(data)}]
    return level, struct.pack('<I4s', len(data), b'BIN\0') + data


def rgbe(color):
    mantissa, exponent = math.frexp(max(color))
    scale = mantissa * 256 / max(color)
    return bytes([int(x * scale) for x in color] + [exponent + 128])


def sky_write(path):
    """An overcast sky, (1 + 2 sin elevation) / 3 of its zenith's radiance (Moon and Spencer 1942), as flat RGBE."""
    width, height = SKY_SIZE
    with open(path, 'wb') as file:
        file.write(b'#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n' % (height, width))
        for row in range(height):
            sine = math.cos(math.pi * (row + 0.5) / height)
            color = [(1 + 2 * sine) / 3 * x for x in ZENITH] if sine > 0 else GROUND
            file.write(width * rgbe(color))
