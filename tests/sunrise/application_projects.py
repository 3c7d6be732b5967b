"""Projects for Java code around motions: time, classes, dialogs, signals, forces."""

from __future__ import annotations

from dataclasses import replace
from math import radians
from pathlib import Path

from poses import Pose, deg
from program import Program, placed
from station import Frame, Load, ProcessData, Station, Tool


def asynchronous(folder: Path) -> Program:
    station = Station(
        frames={
            "Belt": Frame(deg(380, -320, 150, 5, 0, 0)),
            "Belt/Fetch": Frame(Pose(60, 140, 190, 2.46, 0.004, 3.138), -0.1, 2),
            "Belt/Give": Frame(Pose(64, 480, 195, 2.47, 0.003, 3.137), 0.14, 2),
        }
    )
    p = Program(folder, station, "Handover")
    p.ptp("Belt/Fetch", "ptp(fetch).setBlendingRel(0.4)", blend={"sunrise_rel": 0.4})
    p.ptp([0.3, 0.6, 0, -1.2, 0, 1.2, 0], "ptp(0.3, 0.6", blend={"cart_mm": 30})
    p.ptp("Belt/Give", "ptp(give).setBlendingCart(25)")
    p.wait(0.25, "milliSleep(250)")

    p.lin("Belt/Fetch", "lin(fetch).setCartVelocity", cart_velocity_mm_s=150, blend={"cart_mm": 20})
    p.wait(0.1, "milliSleep(100)", overlap=1)
    p.lin_rel(Pose(z=-60), "linRel(0, 0, -60)", cart_velocity_mm_s=200)

    p.ptp("Belt/Give", "ptp(give).setJointVelocityRel", velocity_rel=0.5, blend={"cart_mm": 15})
    p.ptp("Belt/Fetch", "ptp(fetch).setBlendingCart(10)", blend={"cart_mm": 10})
    p.wait(0.7, "Thread.sleep(700)", overlap=2)
    p.ptp([0, 0.6, 0, -1.2, 0, 1.2, 0], "ptp(0, 0.6")

    p.ptp("Belt/Give", "ptp(give).setBlendingCart(40)", blend={"cart_mm": 40})
    p.wait(0.2, "MILLISECONDS.sleep(200)", overlap=1)
    p.lin("Belt/Fetch", "lin(fetch).setBlendingCart(30)", blend={"cart_mm": 30})
    # The wait begins after the previous wait, after the first motion has begun.
    p.wait(0.3, "MILLISECONDS.sleep(300)", overlap=2)
    p.lin("Belt/Give", "lin(give)")

    p.ptp("Belt/Fetch", "ptp(fetch).setBlendingRel(0.8)")
    p.wait(1, "SECONDS.sleep(1)")
    p.ptp([0, 0.3, 0, -1.6, 0, 1.1, 0], "ptp(0, 0.3", blocking=None)
    return p


def classes(folder: Path) -> Program:
    station = Station(
        frames={
            "Bench": Frame(deg(450, 0, 140, 0, 0.2, 0)),
            "Bench/Left": Frame(Pose(20, 160, 110, 2.59, 0.006, 3.139), 0.08, 2, "Driver/Bit"),
            "Bench/Right": Frame(Pose(20, -160, 110, 2.59, 0.006, 3.139), -0.08, 2, "Driver/Bit"),
            "Bath": Frame(deg(380, -300, 120, -30, 0, 0)),
            "Bath/Above": Frame(Pose(30, 40, 260, 3.07, 0.01, 3.135), -0.2, 2, "Driver/Bit"),
            "Bath/In": Frame(Pose(31, 41, 150, 3.07, 0.01, 3.135), -0.2, 2, "Driver/Bit"),
        },
        tools={
            "Driver": Tool({"Bit": Pose(0, 0, 210)}, Load(1.1, (0, 0, 80), (0.003, 0.003, 0.001)))
        },
    )
    p = Program(folder, station, "ScrewStation", "Driver")
    ready = [radians(angle) for angle in [0, 35, 0, -80, 0, 65, 0]]
    p.ptp(ready, ("Poses", "ptp(READY)"), velocity_rel=0.7)
    begin = ("BaseJob", "ptp(begin())")
    p.ptp("Bath/Above", begin, velocity_rel=0.25)
    for _ in range(2):
        p.lin("Bath/In", ("WashJob", '"/Bath/In"'), cart_velocity_mm_s=50)
        p.lin("Bath/Above", ("WashJob", "lin(begin())"), cart_velocity_mm_s=50)
    p.ptp("Bench/Left", begin, velocity_rel=0.5)
    for velocity in [90, 100]:
        p.lin_rel(Pose(z=6.5), ("ScrewJob", "linRel(0, 0, depth)"), cart_velocity_mm_s=4)
        p.lin_rel(Pose(z=-6.5), ("ScrewJob", "linRel(0, 0, -depth)"), cart_velocity_mm_s=20)
        p.lin_rel(Pose(y=-24), ("ScrewJob", "Poses.PITCH"), cart_velocity_mm_s=velocity)
    p.ptp(ready, ("Poses", "ptp(READY)"), velocity_rel=0.7)
    return p


def dialogs(folder: Path) -> Program:
    station = Station(
        frames={
            "Rack": Frame(deg(420, 210, 90, 25, 0, 0)),
            "Rack/Bracket": Frame(Pose(40, -60, 150, 2.11, 0.007, 3.14), 0.12, 2),
            "Rack/Flange": Frame(Pose(42, 55, 152, 2.12, 0.008, 3.139), 0.18, 2),
            "Good": Frame(Pose(480, -180, 240, 2.19, 0.002, 3.138), -0.1, 2),
            "Scrap": Frame(Pose(380, -260, 230, 1.95, 0.003, 3.137), -0.15, 2),
        }
    )
    p = Program(folder, station, "PartChoice")
    p.ptp([0, 0.5, 0, -1.4, 0, 1.2, 0], "ptp(0, 0.5")
    for part, is_good in [(1, True), (2, False), (3, True)]:
        p.ptp("Rack/Flange", "ptp(from)", velocity_rel=0.5)
        p.lin_rel(Pose(z=-70 - 10 * part), "linRel(0, 0, -70", cart_velocity_mm_s=150)
        if is_good:
            p.ptp("Good", '"/Good"')
        else:
            p.lin("Scrap", '"/Scrap"', cart_velocity_mm_s=250)
            p.wait(0.6, "milliSleep(600)")
    return p


def inputs(folder: Path) -> Program:
    station = Station(
        frames={
            "Belt": Frame(deg(400, -200, 130, 0, 0, 0)),
            "Belt/Lane1": Frame(Pose(50, 120, 260, 2.57, 0.004, 3.136), 0.03, 2),
            "Belt/Lane2": Frame(Pose(50, 220, 260, 2.58, 0.004, 3.136), 0.05, 2),
        },
        data={
            "velocity": ProcessData("Double", "0.5", "0.35", "0.01", "1.0"),
            "parts": ProcessData("Integer", "1", "5", "1", "20"),
            "careful": ProcessData("Boolean", "true"),
        },
    )
    p = Program(folder, station, "BeltPick")
    p.ptp([0, 0.4, 0, -1.5, 0, 1.2, 0], "ptp(0, 0.4", velocity_rel=0.35)
    for _ in range(2):
        p.wait_for("Belt.PartPresent", True, "belt.getPartPresent()")
        p.set("Belt.Stopper", True, "belt.setStopper(true)")
        p.ptp("Belt/Lane2", "ptp(lane)", velocity_rel=0.35)
        p.lin_rel(Pose(z=100 - 37.5), "linRel(0, 0, depth)", cart_velocity_mm_s=40)
        p.wait(0.2, "milliSleep(200)")
        p.lin("Belt/Lane2", "lin(lane)", cart_velocity_mm_s=160)
        p.ptp([-0.5, 0.4, 0, -1.5, 0, 1.2, 0], "ptp(-0.5, 0.4")
        p.set("Belt.Stopper", False, "belt.setStopper(false)")
    return p


def compliance(folder: Path) -> Program:
    station = Station(
        frames={
            "Turntable": Frame(deg(520, -20, 110, 45, 0, 0)),
            "Turntable/Above": Frame(Pose(10, -15, 160, 1.77, 0.005, 3.138), 0.04, 2, "Pad/Face"),
        },
        tools={"Pad": Tool({"Face": Pose(0, 0, 96)}, Load(0.8, (0, 0, 40)))},
    )
    p = Program(folder, station, "Polishing", "Pad")
    p.ptp([0, 0.6, 0, -1.2, 0, 1.3, 0], "ptp(0, 0.6", velocity_rel=0.3)
    p.ptp("Turntable/Above", "ptp(above)", velocity_rel=0.4)
    p.lin_rel(Pose(z=45), "linRel(0, 0, 45)", cart_velocity_mm_s=15)
    for _ in range(2):
        p.lin_rel(Pose(y=80), "linRel(0, 80, 0)", cart_velocity_mm_s=60)
        p.lin_rel(Pose(y=-80), "linRel(0, -80, 0)", cart_velocity_mm_s=60)
    p.wait(3, "positionHold(soft")
    p.lin_rel(Pose(z=-45), "linRel(0, 0, -45)", cart_velocity_mm_s=100)
    p.wait(1.5, "positionHold(floating")
    return p


def cell(folder: Path) -> Program:
    cups, carton = (
        Load(1.6, (0, 0, 54), (0.006, 0.005, 0.002)),
        Load(2.4, (0, 0, 60), (0.009, 0.008, 0.007)),
    )
    tcp = "SuctionCups/Centre"
    station = Station(
        frames={
            "Lanes": Frame(deg(300, 380, 40, 35, 0, 0)),
            "Lanes/Small": Frame(Pose(40, -60, 180, 1.94, 0.004, 3.139), 0.14, 2, tcp),
            "Lanes/Large": Frame(Pose(45, 60, 205, 1.95, 0.005, 3.138), 0.2, 2, tcp),
            "Pallet": Frame(deg(400, -330, 35, -20, 0.1, 0)),
            "Pallet/Corner": Frame(Pose(20, 30, 170, 2.9, -0.003, 3.14), -0.12, 2, tcp),
        },
        tools={"SuctionCups": Tool({"Centre": Pose(0, 0, 120)}, cups)},
        workpieces={"Carton": carton},
        data={"velocity": ProcessData("Double", "0.4", "0.6")},
    )
    p = Program(folder, station, "Palletising", "SuctionCups")
    ready = [0, radians(30), 0, radians(-85), 0, radians(65), 0]
    p.ptp(ready, "ptp(READY).setJointVelocityRel(velocity)", velocity_rel=0.6)
    lanes, pallet = station.frames["Lanes"].pose, station.frames["Pallet"].pose

    def raised(pose: Pose) -> Pose:
        return replace(pose, z=pose.z + 80)

    for placed_before, lane in enumerate(["Lanes/Small", "Lanes/Large", "Lanes/Small"]):
        if placed_before == 2:
            p.wait(1, "milliSleep(1000)")
        kept = station.redundancy(lane)
        above = placed(lanes.then(raised(station.frames[lane].pose)), kept)
        p.ptp(
            above,
            "ptp(above).setJointVelocityRel(velocity).setBlendingCart",
            velocity_rel=0.6,
            blend={"cart_mm": 40},
        )
        p.lin(lane, "lin(carrier)", cart_velocity_mm_s=250)
        p.set("Vacuum.Pump", True, "vacuum.setPump(true)")
        p.wait_for("Vacuum.Holds", True, "vacuum.getHolds()")
        p.load(cups.with_one(carton.moved(120)), "carton.attachTo")
        p.wait(0.15, "milliSleep(150)")
        p.lin(above, "lin(above)", cart_velocity_mm_s=400, blend={"cart_mm": 30})

        kept = station.redundancy("Pallet/Corner")
        corner = station.frames["Pallet/Corner"].pose
        place = replace(
            corner, x=corner.x + placed_before % 2 * 90, y=corner.y + placed_before // 2 * 90
        )
        over = placed(pallet.then(raised(place)), kept)
        p.ptp(over, "velocity).setBlendingRel(0.2)", velocity_rel=0.6, blend={"sunrise_rel": 0.2})
        limits = {"cart_velocity_mm_s": 150, "cart_acceleration_mm_s2": 1000}
        p.lin(placed(pallet.then(place), kept), "lin(place)", **limits)
        p.set("Vacuum.Pump", False, "vacuum.setPump(false)")
        p.wait(0.1, "milliSleep(100)")
        p.load(None, "carton.detach")
        p.lin_rel(Pose(z=-80), "linRel(0, 0, -CLEARANCE_MM)", cart_velocity_mm_s=400)
    p.ptp(ready, "Math.max(velocity / 2", velocity_rel=0.3)
    return p
