#!/usr/bin/env python3
"""Time from process start to the first complete picture of the window, and the memory it takes.

    python3 benches/start_up.py [RUNS] [PROGRAM [ARGUMENT ...]]

Runs the program (target/release/gdcm) under a virtual display without a graphics processor, and
takes screenshots for three seconds. A picture is complete except for error bars if less than 1 % of
its bytes differ visibly from the last screenshot, and complete if less than 1 in 10,000 does. The
limit is not zero: curves at rest are replaced by an image later, which differs by less. Prints the
shortest and the median time of the runs, because the first run reads the program from disk.

Needs Linux with Xvfb and xwd (Debian: xvfb, x11-apps).
"""

import os
import statistics
import subprocess
import sys
import time

SCREEN = "1440x900x24"
# Changes of the window after this time are not part of the start.
SETTLED_AFTER_S = 3.0
# Smallest visible difference of a colour value: a quarter of its range, 0 to 255.
VISIBLE = 64


def start_display():
    """A virtual display; returns its process and its name."""
    read, write = os.pipe()
    command = ["Xvfb", "-displayfd", str(write), "-screen", "0", SCREEN, "-nolisten", "tcp"]
    display = subprocess.Popen(command, pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    name = os.read(read, 16).decode().strip()
    return display, f":{name}"


def picture(environment):
    """Return the bytes of a screenshot."""
    command = ["xwd", "-root", "-silent"]
    return subprocess.run(command, env=environment, capture_output=True, check=True).stdout


def difference(picture, last):
    """Return the fraction of bytes that differ visibly; 1 if the sizes differ."""
    if len(picture) != len(last):
        return 1.0
    return sum(abs(a - b) > VISIBLE for a, b in zip(picture, last)) / len(last)


def peak_memory_mb(process):
    """Return the peak resident memory of the process [MB]."""
    with open(f"/proc/{process.pid}/status", encoding="ascii") as status:
        line = next(line for line in status if line.startswith("VmHWM"))
    return int(line.split()[1]) / 1024


def measure(command, environment):
    """Start the program once.

    Return the seconds to the picture without and with error bars, and the peak memory [MB].
    """
    start = time.monotonic()
    program = subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL)
    try:
        # Each new picture, and the seconds after which it was seen.
        pictures = []
        while time.monotonic() - start < SETTLED_AFTER_S:
            shown = picture(environment)
            if not pictures or shown != pictures[-1][1]:
                pictures.append((time.monotonic() - start, shown))
        memory = peak_memory_mb(program)
    finally:
        program.kill()
        program.wait()
    last = pictures[-1][1]
    differences = [(seconds, difference(shown, last)) for seconds, shown in pictures]
    without_bars = first_below(differences, 1e-2)
    complete = first_below(differences, 1e-4)
    return without_bars, complete, memory


def first_below(differences, limit):
    """Return the seconds to the first picture whose difference is below the limit."""
    return next(seconds for seconds, share in differences if share < limit)


def main():
    """Print the minimum and the median over the runs."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    command = sys.argv[2:] or ["target/release/gdcm"]
    display, name = start_display()
    environment = dict(os.environ, DISPLAY=name)
    environment.pop("WAYLAND_DISPLAY", None)
    try:
        results = [measure(command, environment) for _ in range(runs)]
    finally:
        display.kill()
        display.wait()
    without_bars, complete, memory = zip(*results)
    for name, seconds in (("complete except for error bars", without_bars), ("complete", complete)):
        median = statistics.median(seconds)
        print(f"{name}: shortest {min(seconds):.2f} s, median {median:.2f} s")
    print(f"memory: {max(memory):.0f} MB at most")


if __name__ == "__main__":
    main()
