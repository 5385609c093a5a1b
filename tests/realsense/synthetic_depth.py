"""What a stereo camera would see of the footage: a depth picture from the ground truth of one frame.

World: metres, table at z = 0, z up (tests/footage/README.md). The table is a plane, each part a box under its marker,
the hand a row of balls along its bones. Then the picture gets what a real stereo pair does to it. The far side of every
edge is hidden from the second imager (no depth there), edges are fattened by the matching window and blurred into points
that fly between near and far, the disparity is noisy in patches, and some pixels have no match at all.

    synthetic_depth.py CLIP.truth.jsonl OUT.depth

writes the pictures of a whole clip one after the other (Z16, little endian) and OUT.json, the calibration.
"""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "target/runtime/realsense/python"))
try:
    import numpy as np
except ImportError as error:
    sys.exit(f"{error}: run `python3.11 daemon/realsense/provision.py target/runtime --recorder` first")

# Metres of one step of depth: a D400's default.
UNIT_M = 0.001

# D435i: baseline of the stereo pair, and noise of its disparity on a textured surface (data sheet: under 2 % at 2 m).
BASELINE_M = 0.050
DISPARITY_NOISE_PX = 0.08
# Half the matching window.
WINDOW_PX = 3
SPECKLE_SHARE = 0.01

# MediaPipe's bones, as pairs of landmarks; the palm's outline too.
BONES = [(0, 1), (1, 2), (2, 3), (3, 4), (0, 5), (5, 6), (6, 7), (7, 8), (5, 9), (9, 10), (10, 11), (11, 12), (9, 13)]
BONES += [(13, 14), (14, 15), (15, 16), (13, 17), (0, 17), (17, 18), (18, 19), (19, 20), (0, 9), (0, 13)]
# Half the thickness of a hand at each landmark, in metres (means of adult hands; persons differ by some 15 %). Wrist 20, knuckles 13, middle joints
# 9, last joints 8, tips 7 millimetres.
WRIST, KNUCKLE, MIDDLE, LAST, TIP = 0.020, 0.013, 0.009, 0.008, 0.007
RADII = [WRIST, 0.016, KNUCKLE, 0.010, 0.009] + [KNUCKLE, MIDDLE, LAST, TIP] * 4
FOREARM_M = 0.25
# Half the width of a part around the line of its interaction points, in metres: it carries its marker.
PART_HALF_WIDTH_M = 0.020


class DepthCamera:
    """Where the depth imager is, and how it looks. `rotation` and `translation_m`: depth camera to colour camera."""

    def __init__(self, width, height, focal, centre, rotation, translation_m):
        self.width, self.height, self.focal, self.centre = width, height, focal, centre
        self.rotation, self.translation_m = np.asarray(rotation, float), np.asarray(translation_m, float)

    def rays(self, colour_height_m):
        """Origin and directions (height, width, 3) of all pixels in the world; a direction's depth component is 1."""
        u, v = np.meshgrid(np.arange(self.width), np.arange(self.height))
        directions = np.stack([(u - self.centre[0]) / self.focal, (v - self.centre[1]) / self.focal, np.ones(u.shape)], -1)
        colour = directions @ self.rotation.T
        # The colour camera looks straight down: its x is the world's, its y and z are turned over.
        flip = np.array([1.0, -1.0, -1.0])
        return self.translation_m * flip + np.array([0.0, 0.0, colour_height_m]), colour * flip


def d435i():
    """The depth imager of a D435i: wider than the colour one, 15 mm beside it and, here, half a degree askew."""
    angle = np.radians(0.5)
    rotation = [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
    return DepthCamera(640, 480, 385.0, (321.5, 238.5), rotation, (0.015, 0.0002, -0.0003))


def calibration(header, camera):
    eye = header["camera"]
    return {
        "unit_m": UNIT_M,
        "colour": {"focal": [eye["fx"], eye["fy"]], "centre": [eye["cx"], eye["cy"]]},
        "depth": {"size": [camera.width, camera.height], "focal": [camera.focal] * 2, "centre": list(camera.centre)},
        "rotation": camera.rotation.tolist(),
        "translation_m": camera.translation_m.tolist(),
    }


def pictures(header, lines, camera):
    """The depth pictures of these lines of the truth."""
    shapes = {shape["id"]: shape for shape in header["objects"]}
    # One seed: the same clip always gives the same pictures.
    random = np.random.default_rng(1)
    for line in lines:
        exact = render(line, shapes, camera, header["camera"]["height_m"])
        yield as_stereo_sees_it(exact, camera, random)


def render(truth, shapes, camera, colour_height_m, person_scale=1.0):
    """Exact depth in metres, (height, width), of a line of the truth."""
    origin, rays = camera.rays(colour_height_m)
    depth = -origin[2] / rays[..., 2]
    for part in truth["objects"]:
        box(depth, origin, rays, camera, part, shapes[part["id"]])
    for hand in truth["hands"]:
        for centre, radius in balls(np.array(hand["m"]), person_scale):
            ball(depth, origin, rays, camera, centre, radius)
    return depth


def box(depth, origin, rays, camera, part, shape):
    """Puts a part into the picture, in place: a box from its marker's plane down to the table it was made for."""
    points = np.array(shape["interaction_points"])
    low = np.minimum(points.min(0), -shape["marker_side_m"] / 2) - PART_HALF_WIDTH_M / 4
    high = np.maximum(points.max(0), shape["marker_side_m"] / 2) + PART_HALF_WIDTH_M / 4
    low[2], high[2] = -shape["top_above_table_m"], 0.0
    rotation = quaternion_matrix(part["q"])
    corners = [[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    seen = [pixel(camera, origin, rotation @ corner + np.array(part["p"]))[:2] for corner in corners]
    view = window(np.min(seen, 0), np.max(seen, 0))
    start = (origin - np.array(part["p"])) @ rotation
    along = rays[view] @ rotation
    with np.errstate(divide="ignore", invalid="ignore"):
        one, two = (low - start) / along, (high - start) / along
    enter, leave = np.minimum(one, two).max(-1), np.maximum(one, two).min(-1)
    hit = np.where((enter <= leave) & (enter > 0), enter, np.inf)
    depth[view] = np.minimum(depth[view], hit)


def pixel(camera, origin, point):
    """Column, row and depth of a point of the world."""
    flip = np.array([1.0, -1.0, -1.0])
    x, y, z = camera.rotation.T @ ((point - origin) * flip)
    return camera.focal * x / z + camera.centre[0], camera.focal * y / z + camera.centre[1], z


def window(low, high):
    """The pixels between two corners, and one more on each side."""
    (u0, v0), (u1, v1) = np.floor(low).astype(int) - 1, np.ceil(high).astype(int) + 2
    return slice(max(v0, 0), max(v1, 0)), slice(max(u0, 0), max(u1, 0))


def balls(landmarks, scale):
    for a, b in BONES:
        steps = max(2, int(np.linalg.norm(landmarks[a] - landmarks[b]) / 0.004))
        for share in np.linspace(0.0, 1.0, steps):
            yield landmarks[a] * (1 - share) + landmarks[b] * share, scale * (RADII[a] * (1 - share) + RADII[b] * share)
    arm = landmarks[0] - landmarks[9]
    arm /= np.linalg.norm(arm)
    for way in np.arange(0.0, FOREARM_M, 0.008):
        yield landmarks[0] + arm * way, scale * (WRIST + 0.06 * way)


def ball(depth, origin, rays, camera, centre, radius):
    """Puts one ball into the picture, in place; only the pixels around it are touched."""
    u, v, distance = pixel(camera, origin, centre)
    reach = camera.focal * radius / (distance - radius)
    view = window((u - reach, v - reach), (u + reach, v + reach))
    part = rays[view]
    if part.size == 0:
        return
    a, b = (part * part).sum(-1), part @ (origin - centre)
    root = b * b - a * (((origin - centre) ** 2).sum() - radius * radius)
    hit = np.where(root >= 0, (-b - np.sqrt(np.maximum(root, 0))) / a, np.inf)
    depth[view] = np.minimum(depth[view], hit)


def as_stereo_sees_it(depth, camera, random):
    """Depth in steps of `UNIT_M`, uint16, 0 where there is none."""
    exact = camera.focal * BASELINE_M / depth
    disparity = shifted(exact, WINDOW_PX, np.maximum)
    # The window follows the stronger texture: only some of the edge pixels are taken by the nearer side.
    disparity = np.where(patches(random, depth.shape) > 0, disparity, exact)
    flying = (shifted(disparity, 1, np.maximum) - shifted(disparity, 1, np.minimum)) > 1.0
    flying &= random.random(depth.shape) < 0.3
    share = random.random(depth.shape)
    mixed = share * shifted(disparity, 1, np.maximum) + (1 - share) * shifted(disparity, 1, np.minimum)
    disparity = np.where(flying, mixed, disparity)
    hidden = hidden_from_second(disparity)
    disparity = disparity + DISPARITY_NOISE_PX * patches(random, depth.shape)
    steps = np.round(camera.focal * BASELINE_M / disparity / UNIT_M)
    steps[hidden | (random.random(depth.shape) < SPECKLE_SHARE)] = 0
    return steps.clip(0, 65535).astype(np.uint16)


def patches(random, shape):
    """Noise of unit variance that is the same over a few pixels, as a matching window makes it."""
    small = random.standard_normal((shape[0] // 3 + 2, shape[1] // 3 + 2))
    noise = np.kron(small, np.ones((3, 3)))[: shape[0], : shape[1]]
    return 0.8 * noise + 0.6 * random.standard_normal(shape)


def shifted(picture, reach, pick):
    """`pick` of each pixel's neighbourhood, `reach` pixels each way."""
    padded = np.pad(picture, reach, mode="edge")
    for _ in range(2):
        # Along one axis, then, turned over, along the other.
        size = len(padded) - 2 * reach
        picked = padded[:size].copy()
        for k in range(1, 2 * reach + 1):
            pick(picked, padded[k : k + size], out=picked)
        padded = picked.T
    return padded


def hidden_from_second(disparity):
    """Pixels whose match in the second picture is covered by something nearer."""
    height, width = disparity.shape
    columns = np.arange(width)[None, :] - disparity
    # From right to left: a pixel is hidden when one to the right of it lands at or left of its place.
    nearest = np.minimum.accumulate(columns[:, ::-1], axis=1)[:, ::-1]
    beyond = np.concatenate([nearest[:, 1:], np.full((height, 1), np.inf)], axis=1)
    return columns > beyond + 0.5


def quaternion_matrix(q):
    w, x, y, z = q
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    header, *lines = (json.loads(line) for line in open(sys.argv[1]))
    camera = d435i()
    with open(sys.argv[2], "wb") as out:
        for picture in pictures(header, lines, camera):
            out.write(picture.tobytes())
    pathlib.Path(sys.argv[2]).with_suffix(".json").write_text(json.dumps(calibration(header, camera)))


if __name__ == "__main__":
    main()
