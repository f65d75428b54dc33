#!/usr/bin/python3
"""Stands where LinuxCNC expects its screen: runs $PROGRAM once, presses start at every M00, and writes
the time from the first motion to the last into $RESULT."""

import json
import os
import sys
import time

import linuxcnc

command, status, errors = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()


def leave(code, **result):
    with open(os.environ["RESULT"], "w") as out:
        json.dump(result, out)
    sys.exit(code)


def poll_until(true, seconds=20):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        try:
            status.poll()
            if true():
                return
        except linuxcnc.error:
            pass
        time.sleep(0.02)
    leave(3, error="LinuxCNC does not get ready")


def do(call, *arguments):
    call(*arguments)
    command.wait_complete(20)


poll_until(lambda: True)
do(command.state, linuxcnc.STATE_ESTOP_RESET)
do(command.state, linuxcnc.STATE_ON)
do(command.mode, linuxcnc.MODE_MANUAL)
do(command.home, -1)
poll_until(lambda: all(status.homed[: status.joints]))
do(command.mode, linuxcnc.MODE_AUTO)
do(command.program_open, os.environ["PROGRAM"])
status.poll()
start = time.monotonic()
command.auto(linuxcnc.AUTO_RUN, 0)

paused, pause, stops = 0.0, None, 0
first = last = None
seen, running, origin = None, False, None
while True:
    status.poll()
    now = time.monotonic() - start
    error = errors.poll()
    if error and error[0] in (linuxcnc.OPERATOR_ERROR, linuxcnc.NML_ERROR):
        leave(2, error=error[1])
    position = status.position[:3]
    if origin is None:
        origin = position
    if seen is not None and position != seen:
        if first is None:
            # Status is polled some milliseconds late: at constant acceleration a way s at a speed v
            # takes 2 s / v from rest.
            way = sum((a - b) ** 2 for a, b in zip(position, origin)) ** 0.5
            late = 2 * way / status.current_vel if status.current_vel > 0 else 0
            first = now - paused - late
        last = now - paused
    seen = position
    running = running or status.interp_state != linuxcnc.INTERP_IDLE
    if running and status.interp_state == linuxcnc.INTERP_PAUSED:
        if pause is None:
            pause, stops = now, stops + 1
            command.auto(linuxcnc.AUTO_RESUME)
    elif pause is not None:
        paused, pause = paused + now - pause, None
    if running and status.interp_state == linuxcnc.INTERP_IDLE and status.inpos and not status.queue:
        leave(0, motion_s=last - first, stops=stops, end=position)
    if now > 1800:
        leave(3, error="the program does not end")
    time.sleep(0.002)
