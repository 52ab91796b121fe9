"""Writes a ROS 1 bag by Debian's python3-rosbag, for a test that lays it beside our own writer's.

write_rosbag.py MANIFEST BAG COMPRESSION: a line of MANIFEST is `topic type nanoseconds file`, the file holding a
message as ROS 1 serialises it. Messages are taken apart and written anew by ROS' own classes."""

import importlib
import os
import sys

import genpy
import rosbag


def message_class(name):
    # Debian has tf2's message alone; tf's is the same by another name.
    package, kind = ("tf2_msgs", "TFMessage") if name == "tf/tfMessage" else name.split("/")
    return getattr(importlib.import_module(package + ".msg"), kind)


def main():
    manifest, bag, compression = sys.argv[1:]
    with rosbag.Bag(bag, "w", compression=compression) as out:
        for line in open(manifest):
            topic, kind, nanoseconds, name = line.split()
            with open(os.path.join(os.path.dirname(manifest), name), "rb") as file:
                message = message_class(kind)().deserialize(file.read())
            seconds, rest = divmod(int(nanoseconds), 10**9)
            out.write(topic, message, genpy.Time(seconds, rest))


main()
