#!/usr/bin/env python3
"""Swings joint 1 of the robot there and back: an example client of iiwaDrive. Needs pyzmq."""
import argparse, json, sys, zmq, zmq.auth

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--drive", default="tcp://127.0.0.1:5560", help="address for requests")
parser.add_argument("--stream", default="tcp://127.0.0.1:5561", help="address of the stream")
parser.add_argument("--key", help="own key of `iiwasim keygen`, if the drive requires keys")
parser.add_argument("--server-key", help="the drive's public key")
options = parser.parse_args()

def connect(kind, address):
    socket = zmq.Context.instance().socket(kind)
    socket.linger = 0
    if options.key:
        socket.curve_publickey, socket.curve_secretkey = zmq.auth.load_certificate(options.key)
        socket.curve_serverkey, _ = zmq.auth.load_certificate(options.server_key)
    socket.connect(address)
    return socket

def ask(request, wait=lambda drive: drive.poll(5000)):
    drive = connect(zmq.REQ, options.drive)
    drive.send_json(request)
    reply = drive.recv_json() if wait(drive) else {"ok": False, "error": "no answer"}
    return reply if reply["ok"] else sys.exit(f"the drive says: {reply['error']}")

def watch(drive):  # the reply arrives when the robot is at rest; Ctrl-C stops the robot
    try:
        while not drive.poll(0) and stream.poll(3000):
            joints_rad = json.loads(stream.recv_multipart()[1])["joints_rad"]
            print(f"\rA1 at {joints_rad[0]:+.4f} rad", end="", flush=True)
    except KeyboardInterrupt:
        ask({"type": "stop"})
    return drive.poll(5000)

(stream := connect(zmq.SUB, options.stream)).subscribe("joints")
here = ask({"type": "state"})["joints_rad"] or sys.exit("the drive reports no joint positions")
swings = [[here[0] + by, *here[1:]] for by in (0.2, 0)]
motions = [{"type": "ptp", "joints_rad": swing, "velocity_rel": 0.2} for swing in swings]
run = ask({"type": "run_motions", "motions": motions, "label": {"program": "swing"}}, watch)
cycle_time_s, count = run.get("cycle_time_s", float("nan")), len(run["samples"]["t_s"])
print(f"\nmeasured: {cycle_time_s:.3f} s, {count} samples")
