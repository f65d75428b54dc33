"""What a control takes against the errors of a machine."""

from __future__ import annotations

import ballbar
import pytest

CONTROLS = ["linuxcnc", "isg", "siemens", "fanuc", "klipper", "marlin", "reprapfirmware", "grblhal", "csv"]


@pytest.mark.parametrize("control", CONTROLS)
def test_every_control_takes_files_that_leave_less(campaign: ballbar.Campaign, control: str) -> None:
    compensation = ballbar.compensate(campaign, control)
    report = compensation.report()
    assert compensation.control == report["control"] == control
    assert list(compensation.files) == report["files"]
    assert all(compensation.files.values())
    assert report["after"]["rms_um"] < report["before"]["rms_um"]
    assert report["machine"] in compensation.text


def test_files_that_were_active_are_in_those_that_come_after(campaign: ballbar.Campaign) -> None:
    first = ballbar.compensate(campaign, "linuxcnc")
    second = ballbar.compensate(campaign, "linuxcnc", on_top=list(first.files.items()))
    assert not first.report()["holds_what_was_active"]
    assert second.report()["holds_what_was_active"]
