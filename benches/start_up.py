#!/usr/bin/env python3
"""Time from process start to the first complete picture of the window, and the memory it takes.

    python3 benches/start_up.py [RUNS] [PROGRAM [ARGUMENT ...]]

Runs the program (target/release/gdcm) under a virtual display without a graphics processor and looks at the screen again and
again; the first complete picture is the one that does not change any more. Needs Linux with Xvfb and xwd (Debian: xvfb,
x11-apps). The shortest and the median of the runs are printed: the first run reads the program from disk.
"""

import hashlib
import os
import statistics
import subprocess
import sys
import time

SCREEN = "1440x900x24"
# Nothing changes in the window after that, or it is not the start that is slow.
SETTLED_AFTER_S = 3.0


def start_display():
    """A virtual display; returns its process and its name."""
    read, write = os.pipe()
    command = ["Xvfb", "-displayfd", str(write), "-screen", "0", SCREEN, "-nolisten", "tcp"]
    display = subprocess.Popen(command, pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    name = os.read(read, 16).decode().strip()
    return display, f":{name}"


def picture(environment):
    """A digest of what the screen shows."""
    screen = subprocess.run(["xwd", "-root", "-silent"], env=environment, capture_output=True, check=True)
    return hashlib.blake2b(screen.stdout).digest()


def peak_memory_mb(process):
    """The most memory that the process has had, resident [MB]."""
    with open(f"/proc/{process.pid}/status", encoding="ascii") as status:
        line = next(line for line in status if line.startswith("VmHWM"))
    return int(line.split()[1]) / 1024


def measure(command, environment):
    """One start: seconds to the first complete picture, peak memory [MB]."""
    start = time.monotonic()
    program = subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL)
    try:
        seen, since = None, 0.0
        while time.monotonic() - start < SETTLED_AFTER_S:
            shown = picture(environment)
            if shown != seen:
                seen, since = shown, time.monotonic() - start
        return since, peak_memory_mb(program)
    finally:
        program.kill()
        program.wait()


def main():
    """Prints the shortest and the median of the runs."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    command = sys.argv[2:] or ["target/release/gdcm"]
    display, name = start_display()
    environment = {key: value for key, value in os.environ.items() if key != "WAYLAND_DISPLAY"} | {"DISPLAY": name}
    try:
        results = [measure(command, environment) for _ in range(runs)]
    finally:
        display.kill()
        display.wait()
    seconds, memory = zip(*results)
    print(f"first complete picture: {min(seconds):.2f} s at best, {statistics.median(seconds):.2f} s in the median")
    print(f"memory: {max(memory):.0f} MB at most")


if __name__ == "__main__":
    main()
