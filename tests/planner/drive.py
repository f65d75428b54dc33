#!/usr/bin/python3
"""Stands where LinuxCNC expects its screen: runs $PROGRAM once and presses start at every M00. The motion is
recorded by the servo thread itself; here only what went wrong is told, into $RESULT."""

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


def poll_until(true, seconds=200):
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
    command.wait_complete(200)


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

running = pressed = False
stops = 0
while True:
    status.poll()
    error = errors.poll()
    if error and error[0] in (linuxcnc.OPERATOR_ERROR, linuxcnc.NML_ERROR):
        leave(2, error=error[1])
    running = running or status.interp_state != linuxcnc.INTERP_IDLE
    if running and status.interp_state == linuxcnc.INTERP_PAUSED:
        if not pressed:
            pressed, stops = True, stops + 1
            command.auto(linuxcnc.AUTO_RESUME)
    else:
        pressed = False
    if running and status.interp_state == linuxcnc.INTERP_IDLE and status.inpos and not status.queue:
        # What was moved last is on its way from the servo thread to the file.
        time.sleep(2)
        leave(0, stops=stops)
    if time.monotonic() - start > 1800:
        leave(3, error="the program does not end")
    time.sleep(0.002)
