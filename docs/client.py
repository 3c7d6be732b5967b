#!/usr/bin/env python3
"""Swings joint 1 of the robot there and back: an example of a client of iiwaDrive. Ctrl-C stops the robot.

client.py [--drive ADDRESS] [--stream ADDRESS] [--key NAME.key --server-key drive.pub]; needs pyzmq."""
import argparse, json, sys
import zmq, zmq.auth

parser = argparse.ArgumentParser()
parser.add_argument("--drive", default="tcp://127.0.0.1:5560", help="where it takes requests")
parser.add_argument("--stream", default="tcp://127.0.0.1:5561", help="where it publishes")
parser.add_argument("--key", help="own key of `iiwasim keygen`, if the drive asks for keys")
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

def answer(drive):
    reply = drive.recv_json() if drive.poll(5000) else {"ok": False, "error": "no answer"}
    return reply if reply["ok"] else sys.exit(f"the drive says: {reply['error']}")

def ask(request):
    drive = connect(zmq.REQ, options.drive)
    drive.send_json(request)
    return answer(drive)

stream = connect(zmq.SUB, options.stream)
stream.subscribe("joints")
here = ask({"type": "state"})["joints_rad"] or sys.exit("the drive does not hear the robot")
there = [here[0] + 0.2, *here[1:]]
motions = [{"type": "ptp", "joints_rad": q, "velocity_rel": 0.2} for q in (there, here)]
drive = connect(zmq.REQ, options.drive)
drive.send_json({"type": "run_motions", "motions": motions})
try:
    while not drive.poll(0):  # the answer comes when the robot stands again
        if not stream.poll(3000):
            sys.exit("\nnothing comes any more; the robot may still be moving")
        topic, message = stream.recv_multipart()
        print(f"\rA1 at {json.loads(message)['joints_rad'][0]:+.4f} rad", end="")
except KeyboardInterrupt:
    ask({"type": "stop"})  # by another socket: this one waits
run = answer(drive)
print(f"\nmeasured: {run['cycle_time_s']:.3f} s, {len(run['samples']['t_s'])} samples")
