#!/usr/bin/env python3
"""Time from process start to the first complete picture of the window, and the memory it takes.

    python3 benches/start_up.py [RUNS] [PROGRAM [ARGUMENT ...]]

Runs the program (target/release/gdcm) under a virtual display without a graphics processor and looks at the screen again and
again until nothing changes. A picture is complete but for error bars where less than 1 % of its bytes differ by a quarter of the
scale from the last one, and complete where less than 1 in 10,000 does: curves at rest become one image later, which differs less.
Needs Linux with Xvfb and xwd (Debian: xvfb, x11-apps). The shortest and the median of the runs are printed: the first run reads the
program from disk.
"""

import os
import statistics
import subprocess
import sys
import time

SCREEN = "1440x900x24"
# Any later change in the window is not part of the start.
SETTLED_AFTER_S = 3.0
# Visible difference of a colour value: a quarter of its range, 0 to 255.
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
    return subprocess.run(["xwd", "-root", "-silent"], env=environment, capture_output=True, check=True).stdout


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
    """Start once; return the seconds to the picture without and with error bars, and the peak memory
    [MB]."""
    start = time.monotonic()
    program = subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL)
    try:
        seen = []
        while time.monotonic() - start < SETTLED_AFTER_S:
            shown = picture(environment)
            if not seen or shown != seen[-1][1]:
                seen.append((time.monotonic() - start, shown))
        memory = peak_memory_mb(program)
    finally:
        program.kill()
        program.wait()
    differences = [(since, difference(shown, seen[-1][1])) for since, shown in seen]
    return *(next(since for since, of in differences if of < limit) for limit in (1e-2, 1e-4)), memory


def main():
    """Print the minimum and the median over the runs."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    command = sys.argv[2:] or ["target/release/gdcm"]
    display, name = start_display()
    environment = {key: value for key, value in os.environ.items() if key != "WAYLAND_DISPLAY"} | {"DISPLAY": name}
    try:
        results = [measure(command, environment) for _ in range(runs)]
    finally:
        display.kill()
        display.wait()
    without_bars, complete, memory = zip(*results)
    for what, seconds in (("complete but for error bars", without_bars), ("complete", complete)):
        print(f"{what}: {min(seconds):.2f} s at best, {statistics.median(seconds):.2f} s in the median")
    print(f"memory: {max(memory):.0f} MB at most")


if __name__ == "__main__":
    main()
