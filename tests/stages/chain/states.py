"""Compares two states bit for bit: all of /meshes and /restart, and the root's time and step."""

import h5py
import numpy


def datasets(file):
    found = {}
    for root in ("meshes", "restart"):
        file[root].visititems(lambda name, item: found.__setitem__(f"{root}/{name}", item) if isinstance(item, h5py.Dataset) else None)
    return found


def differences(path_a, path_b):
    """Names of what differs; empty when the states are the same."""
    with h5py.File(path_a) as a, h5py.File(path_b) as b:
        left, right = datasets(a), datasets(b)
        found = [f"{name}: only in one" for name in sorted(set(left) ^ set(right))]
        for name in sorted(set(left) & set(right)):
            x, y = left[name][...], right[name][...]
            if x.dtype != y.dtype or x.shape != y.shape or x.tobytes() != y.tobytes():
                largest = numpy.max(numpy.abs(x.astype(float) - y.astype(float))) if x.shape == y.shape and x.size else "shape"
                found.append(f"{name}: largest difference {largest}")
        found += [f"{key}: {a.attrs[key]} and {b.attrs[key]}" for key in ("time_s", "step", "final") if a.attrs[key] != b.attrs[key]]
    return found


def newest(folder):
    states = sorted(folder.glob("state_*.h5"), key=lambda p: int(p.stem.split("_")[1]))
    return states[-1] if states else None
