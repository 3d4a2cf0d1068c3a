#!/usr/bin/env python3
"""`path` against the scalar RGB path tracer of Mitsuba 3, on the same scene in the same run.

    pip install mitsuba numpy OpenEXR
    python3 benches/against_mitsuba.py target/release/kaustik [SPP] [SEEDS]

Both render the built-in scene `cornell` (exported as glTF, its colours turned to RGB for
Mitsuba) at 128 x 128, depth 32, box filter, on all cores. The two take turns, once a seed.
Speed is samples a second of rendering alone; error is the mean over pixels and channels of
variance / (mean^2 + 0.01 grand mean^2) between the seeds' pictures.
"""

import json
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import mitsuba as mi
import numpy as np
import OpenEXR

SIDE, DEPTH = 128, 32
WHITE, RED, GREEN = [0.725, 0.71, 0.68], [0.63, 0.065, 0.05], [0.14, 0.45, 0.091]


def read_exr(path):
    channels = OpenEXR.File(str(path)).parts[0].channels
    if "RGB" in channels:
        return np.asarray(channels["RGB"].pixels, dtype=np.float64)
    return np.stack([np.asarray(channels[c].pixels, dtype=np.float64) for c in "RGB"], -1)


def triangles(gltf, binary, primitive):
    """Positions and indices of a primitive of our own export (tight, 32-bit)."""

    def view(accessor, kind, width):
        accessor = gltf["accessors"][accessor]
        chunk = gltf["bufferViews"][accessor["bufferView"]]
        start = chunk.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        count = accessor["count"] * width
        return np.frombuffer(binary, kind, count, start).reshape(-1, width)

    positions = view(primitive["attributes"]["POSITION"], "<f4", 3)
    return positions, view(primitive["indices"], "<u4", 1).reshape(-1, 3)


def mitsuba_scene(glb, folder, lamp):
    data = glb.read_bytes()
    length = struct.unpack("<I", data[12:16])[0]
    gltf, binary = json.loads(data[20 : 20 + length]), data[28 + length :]
    scene = {"type": "scene", "integrator": {"type": "path", "max_depth": DEPTH}}
    for index, node in enumerate(gltf["nodes"]):
        matrix = np.array(node.get("matrix", np.eye(4).T.flatten())).reshape(4, 4).T
        if "camera" in node:
            camera = gltf["cameras"][node["camera"]]["perspective"]
            # Mitsuba's camera looks along +z with x to the left.
            to_world = matrix @ np.diag([-1.0, 1.0, -1.0, 1.0])
            scene["camera"] = {
                "type": "perspective",
                "fov": float(np.degrees(camera["yfov"])),
                "fov_axis": "y",
                "to_world": mi.ScalarTransform4f(to_world),
                "film": {
                    "type": "hdrfilm",
                    "width": SIDE,
                    "height": SIDE,
                    "rfilter": {"type": "box"},
                    "pixel_format": "rgb",
                },
                "sampler": {"type": "independent"},
            }
            continue
        for primitive in gltf["meshes"][node["mesh"]]["primitives"]:
            material = gltf["materials"][primitive["material"]]
            key = material.get("extras", {}).get("kaustik", {})
            positions, indices = triangles(gltf, binary, primitive)
            positions = positions @ matrix[:3, :3].T + matrix[:3, 3]
            path = folder / f"{index}.obj"
            with open(path, "w") as out:
                out.writelines(f"v {x} {y} {z}\n" for x, y, z in positions)
                out.writelines(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in indices)
            colour = {"cornell-red": RED, "cornell-green": GREEN}.get(key.get("reflectance"), WHITE)
            shape = {
                "type": "obj",
                "filename": str(path),
                "face_normals": True,
                "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": colour}},
            }
            if "emission" in key or any(material.get("emissiveFactor", [0])):
                shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": lamp}}
            else:
                shape["bsdf"] = {"type": "twosided", "bsdf": shape["bsdf"]}
            scene[f"shape{index}"] = shape
    return mi.load_dict(scene)


def error(pictures):
    pictures = np.stack(pictures)
    mean, variance = pictures.mean(0), pictures.var(0, ddof=1)
    return float((variance / (mean**2 + 0.01 * mean.mean() ** 2)).mean())


def main():
    kaustik = sys.argv[1]
    spp = int(sys.argv[2]) if len(sys.argv) > 2 else 256
    seeds = int(sys.argv[3]) if len(sys.argv) > 3 else 7
    mi.set_variant("scalar_rgb")
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        glb = folder / "cornell.glb"
        subprocess.run([kaustik, "scenes", "cornell", "--export", glb], check=True)
        # The lamp's colour as our own picture shows it.
        first = folder / "first.exr"
        words = f"render {glb} --method path --width {SIDE} --spp 64 --max-depth 1 -q --no-features"
        subprocess.run([kaustik, *words.split(), "-o", first], check=True)
        seen = read_exr(first).reshape(-1, 3)
        seen = seen[seen.sum(1) > 0.9 * seen.sum(1).max()]
        theirs = mitsuba_scene(glb, folder, [float(c) for c in seen.mean(0)])
        ours, rates = ([], []), ([], [])
        for seed in range(seeds):
            exr, stats = folder / "k.exr", folder / "k.json"
            words = f"render {glb} --method path --width {SIDE} --spp {spp} --max-depth {DEPTH} --seed {seed} -q --no-features"
            subprocess.run([kaustik, *words.split(), "-o", exr, "--stats", stats], check=True)
            ours[0].append(read_exr(exr))
            rates[0].append(spp * SIDE * SIDE / json.loads(stats.read_text())["statistics"]["seconds"])
            start = time.perf_counter()
            picture = np.asarray(mi.render(theirs, spp=spp, seed=seed), dtype=np.float64)
            rates[1].append(spp * SIDE * SIDE / (time.perf_counter() - start))
            ours[1].append(picture)
    speed = [float(np.median(rate)) for rate in rates]
    errors = [error(pictures) for pictures in ours]
    means = [np.mean(pictures, axis=(0, 1, 2)) for pictures in ours]
    for name, s, e, m in zip(("kaustik", "mitsuba"), speed, errors, means):
        print(f"{name}: {s * 1e-6:.3f} M samples/s, relative variance {e:.5f} at {spp} spp, mean {m.round(4)}")
    print(f"speed ratio {speed[0] / speed[1]:.2f}, error ratio (variance) {errors[0] / errors[1]:.3f}")


main()
