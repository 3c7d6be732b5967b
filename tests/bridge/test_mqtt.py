"""Features of MQTT: retained messages, last wills, rates, and reply properties."""

from __future__ import annotations

import json
import signal
import time
import uuid
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from bridges import Bridge, Schema
from messages import command
from mosquitto import PASSWORD, USER, Mosquitto
from processes import until
from readers import MqttClient
from robots import LONG, SHORT, Robot
from ways import MqttWay, of, read_until, tells_losses

Start = Callable[..., Bridge]


@pytest.fixture(params=[4, 5], ids=["3.1.1", "5"])
def way(request: pytest.FixtureRequest, mosquitto: Mosquitto, name: str) -> Iterator[MqttWay]:
    with MqttWay(mosquitto, name, request.param) as way:
        yield way


def kept(way: MqttWay) -> dict[str, dict]:
    """Retained messages that a new subscriber gets, by kind."""
    with MqttClient(way.broker.port(), way.topic("+"), f"end/{way.robot}") as late:
        # Retained messages arrive before messages published after the subscription.
        late.publish(f"end/{way.robot}", "end")
        late.until(lambda: late.of(f"end/{way.robot}"), "all that was retained is read")
        retained = [message for message in late.received if message.retained]
        return {message.topic.removeprefix(way.topic("")): message.json() for message in retained}


def status(way: MqttWay) -> dict:
    return kept(way).get("bridge", {})


def test_events_are_retained_and_samples_are_not(
    way: MqttWay, bridge: Start, simulated_robot: Robot, schema: Schema
) -> None:
    bridge(simulated_robot, *way.options)
    read_until(way, lambda: of(way, "joints"), "joints are passed on")
    simulated_robot.run_motions(SHORT)
    read_until(
        way,
        lambda: len(of(way, "run")) == 2 and of(way, "io") and of(way, "sensors"),
        "events are passed on",
    )
    read_until(way, lambda: of(way, "state")[-1]["state"] == "idle", "the robot is idle")
    found = kept(way)
    assert set(found) == {"state", "run", "io", "sensors", "conditions", "bridge"}
    for message in found.values():
        schema.check(message)
    assert found["state"]["state"] == "idle"
    assert found["run"]["event"] == "end"
    assert found["bridge"]["online"] is True
    assert {message.qos for message in way.client.of(way.topic("run"))} == {1}
    assert {message.qos for message in way.client.of(way.topic("joints"))} == {0}


def test_state_is_there_before_anything_moves(
    way: MqttWay, bridge: Start, simulated_robot: Robot
) -> None:
    """The first subscriber learns whether the robot is idle."""
    bridge(simulated_robot, *way.options)
    read_until(way, lambda: of(way, "state"), "the state is passed on", patience_s=20)


def test_killed_bridge_is_offline(
    way: MqttWay, bridge: Start, simulated_robot: Robot, schema: Schema
) -> None:
    passing = bridge(simulated_robot, *way.options)
    read_until(way, lambda: of(way, "bridge"), "the bridge is online")
    until(lambda: status(way).get("online") is True, "the bridge is online")
    passing.kill()
    until(lambda: status(way).get("online") is False, "its last will is there")
    schema.check(status(way))
    bridge(simulated_robot, *way.options)
    until(lambda: status(way).get("online") is True, "the next one is online")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=["ctrl-c", "terminated"])
def test_ended_bridge_is_offline(
    way: MqttWay, bridge: Start, simulated_robot: Robot, number: int
) -> None:
    passing = bridge(simulated_robot, *way.options)
    until(lambda: status(way).get("online") is True, "the bridge is online")
    passing.send(number)
    passing.wait(30)
    until(
        lambda: status(way).get("online") is False,
        "the bridge says that it is offline",
        patience_s=5,
    )


def test_bridge_is_online_again_after_the_broker_was_away(
    way: MqttWay, bridge: Start, simulated_robot: Robot
) -> None:
    bridge(simulated_robot, *way.options)
    until(lambda: status(way).get("online") is True, "the bridge is online")
    for again in (way.broker.stop, way.broker.kill):
        again()
        time.sleep(0.5)
        way.broker.start()
        began = time.monotonic()
        before = len(of(way, "joints"))
        read_until(
            way, lambda before=before: len(of(way, "joints")) > before, "joints are passed on"
        )
        until(lambda: status(way).get("online") is True, "the bridge is online")
        print(f"online {time.monotonic() - began:.1f} s after the broker")


def test_unresponsive_bridge_is_offline(
    way: MqttWay, bridge: Start, simulated_robot: Robot
) -> None:
    """The broker detects a blocked bridge by the missing keep-alive, and the bridge reconnects."""
    passing = bridge(simulated_robot, *way.options)
    until(lambda: status(way).get("online") is True, "the bridge is online")
    passing.send(signal.SIGSTOP)
    until(lambda: status(way).get("online") is False, "its last will is there")
    passing.send(signal.SIGCONT)
    until(lambda: status(way).get("online") is True, "the bridge is online")


def test_refused_message_is_left_out(
    tmp_path: Path, bridge: Start, simulated_robot: Robot, name: str
) -> None:
    """A message refused by broker rules does not block others, and the bridge reports the loss."""
    strict = Mosquitto(tmp_path / "strict", forbidden=f"iiwasim/{name}/run")
    with (
        strict as broker,
        MqttWay(broker, name) as way,
        MqttClient(broker.port("password"), way.topic("#"), user=(USER, PASSWORD)) as unlimited,
    ):
        passing = bridge(simulated_robot, *way.options)
        read_until(way, lambda: of(way, "joints"), "joints are passed on")
        simulated_robot.run_motions(SHORT)
        read_until(way, lambda: tells_losses(way, 2), "both events of the run are counted")
        states = [message["state"] for message in of(way, "state")]
        assert states[-1] == "idle" and "running_motion" in states
        assert unlimited.of(way.topic("state")) and not unlimited.of(way.topic("run"))
        assert "the broker refuses messages: NotAuthorized" in passing.said()


@pytest.mark.parametrize("rate", [5.0, 50.0])
def test_rate(
    mosquitto: Mosquitto, bridge: Start, quick_robot: Robot, name: str, rate: float
) -> None:
    with MqttWay(mosquitto, name) as way:
        options = way.options.copy()
        options[options.index("--mqtt-rate") + 1] = str(rate)
        bridge(quick_robot, *options)
        read_until(way, lambda: len(of(way, "joints")) > 20, "joints are passed on")
        samples = of(way, "joints")
        measured = (len(samples) - 1) / (samples[-1]["t_s"] - samples[0]["t_s"])
        print(f"asked for {rate} Hz, {measured:.1f} Hz are passed on")
        # A higher rate violates the option; a lower rate may be due to the machine.
        assert measured < 1.2 * rate


def refusal_of(way: MqttWay, identity: str) -> str:
    """Reason for refusing a command."""
    read_until(
        way,
        lambda: [it for it in way.replies if it.get("id") == identity],
        "the command is answered",
    )
    (reply,) = (it["reply"] for it in way.replies if it.get("id") == identity)
    assert not reply["ok"], reply
    return reply["error"]["message"]


def test_reply_goes_where_it_is_asked_for(
    mosquitto: Mosquitto, bridge: Start, simulated_robot: Robot, name: str
) -> None:
    """MQTT 5: the reply uses the topic and the correlation data of the request."""
    with MqttWay(mosquitto, name) as way:
        answers = way.topic(f"reply/{uuid.uuid4().hex}")
        bridge(simulated_robot, *way.options, "--allow-commands")
        # The bridge subscribes before it sends joints.
        read_until(way, lambda: of(way, "joints"), "joints are passed on")
        with MqttClient(mosquitto.port(), answers) as client:
            body = json.dumps(command(name, "state"))
            client.publish(
                way.topic("request"),
                body,
                ResponseTopic=answers,
                CorrelationData=b"\x00\x01 any bytes",
            )
            client.until(lambda: client.received, "there is a reply")
            reply = client.received[0]
        assert reply.json()["reply"]["ok"]
        assert bytes.fromhex(reply.properties["CorrelationData"]) == b"\x00\x01 any bytes"
        way.take()
        assert not way.replies


def test_foreign_response_topic_is_refused(
    mosquitto: Mosquitto, bridge: Start, simulated_robot: Robot, name: str
) -> None:
    """The bridge may have rights that the sender lacks, such as to publish requests to another
    robot.
    """
    with MqttWay(mosquitto, name) as way:
        bridge(simulated_robot, *way.options, "--allow-commands")
        read_until(way, lambda: of(way, "joints"), "joints are passed on")
        before = simulated_robot.joints()
        requests = way.topic("request")
        foreign = [
            f"answers/{name}",
            requests,
            way.topic("state"),
            way.topic("reply") + "s",
            f"iiwasim/{name}-2/request",
            f"iiwasim/{name}-2/reply/1",
        ]
        with MqttClient(mosquitto.port(), *foreign) as listener:
            for where in foreign:
                body = command(name, "run_motions", motions=LONG["motions"])
                listener.publish(
                    requests, json.dumps(body), ResponseTopic=where, CorrelationData=b"7f3c"
                )
                assert f"the response topic has to be `{way.topic('reply')}`" in refusal_of(
                    way, body["id"]
                )
            # A message of the bridge there would arrive before this one.
            listener.publish(foreign[0], "end")
            listener.until(
                lambda: [it for it in listener.received if it.payload == b"end"], "all is read"
            )
            heard = [
                message for message in listener.received if b'"kind":"reply"' in message.payload
            ]
        assert not heard
        replies = way.client.of(way.topic("reply"))
        assert {reply.properties["CorrelationData"] for reply in replies} == {b"7f3c".hex()}
        assert simulated_robot.is_idle() and simulated_robot.joints() == before
        assert not of(way, "run")


def test_retained_command_is_refused(way: MqttWay, bridge: Start, simulated_robot: Robot) -> None:
    """The broker would deliver a retained command to each bridge that subscribes."""
    body = command(way.robot, "run_motions", motions=LONG["motions"])
    way.client.publish(way.topic("request"), json.dumps(body), retain=True)
    before = simulated_robot.joints()
    bridge(simulated_robot, *way.options, "--allow-commands")
    assert "the command is retained" in refusal_of(way, body["id"])
    assert simulated_robot.is_idle() and simulated_robot.joints() == before
    assert not of(way, "run")
    way.client.publish(way.topic("request"), b"", retain=True)


def test_command_retained_while_the_bridge_is_subscribed_is_refused(
    mosquitto: Mosquitto, bridge: Start, simulated_robot: Robot, name: str
) -> None:
    """MQTT 5: the broker passes the flag on."""
    with MqttWay(mosquitto, name) as way:
        first = bridge(simulated_robot, *way.options, "--allow-commands")
        read_until(way, lambda: of(way, "joints"), "joints are passed on")
        before = simulated_robot.joints()
        for kind, request in [("run_motions", {"motions": LONG["motions"]}), ("stop", {})]:
            body = command(name, kind, **request)
            way.client.publish(way.topic("request"), json.dumps(body), retain=True)
            assert "the command is retained" in refusal_of(way, body["id"])
        # With the next connection, the last command is delivered again, and refused again.
        first.end()
        way.replies.clear()
        bridge(simulated_robot, *way.options, "--allow-commands")
        assert "the command is retained" in refusal_of(way, body["id"])
        # The retained command is removed without a reply, and the next command is an ordinary one.
        way.replies.clear()
        way.client.publish(way.topic("request"), b"", retain=True)
        body = command(name, "state")
        way.send(json.dumps(body).encode())
        read_until(way, lambda: way.replies, "the command is answered")
        assert [reply["id"] for reply in way.replies] == [body["id"]] and way.replies[0]["reply"][
            "ok"
        ]
        assert simulated_robot.is_idle() and simulated_robot.joints() == before
        assert not of(way, "run")


def test_retained_command_runs_once_by_3_1_1(
    mosquitto: Mosquitto, bridge: Start, simulated_robot: Robot, name: str
) -> None:
    """MQTT 3.1.1: the broker clears the flag for current subscribers, as the guide says. Later
    deliveries are refused.
    """
    with MqttWay(mosquitto, name, 4) as way:
        first = bridge(simulated_robot, *way.options, "--allow-commands")
        read_until(way, lambda: of(way, "joints"), "joints are passed on")
        body = command(name, "run_motions", motions=SHORT["motions"])
        way.client.publish(way.topic("request"), json.dumps(body), retain=True)
        read_until(
            way, lambda: [it for it in way.replies if it["id"] == body["id"]], "the run has ended"
        )
        assert way.replies[0]["reply"]["ok"]
        # Delivered to the same bridge again, like a repetition by the broker.
        way.replies.clear()
        way.send(json.dumps(body).encode())
        assert "has been received before" in refusal_of(way, body["id"])
        first.end()
        way.replies.clear()
        before = simulated_robot.joints()
        bridge(simulated_robot, *way.options, "--allow-commands")
        assert "the command is retained" in refusal_of(way, body["id"])
        assert simulated_robot.is_idle() and simulated_robot.is_at(before)
        assert len([it for it in of(way, "run") if it["event"] == "begin"]) == 1
        way.client.publish(way.topic("request"), b"", retain=True)


def test_two_bridges_of_one_name_take_turns_without_harm(
    way: MqttWay, bridge: Start, simulated_robot: Robot
) -> None:
    """The broker disconnects the first bridge when the second connects; neither may reconnect
    without a pause.
    """
    passing = [bridge(simulated_robot, *way.options) for _ in range(2)]
    time.sleep(5)
    way.take()
    assert all(each.runs() for each in passing)
    said = max(len(each.said()) for each in passing)
    assert said < 20_000, "it floods its log"


def test_latency(way: MqttWay, bridge: Start, quick_robot: Robot) -> None:
    """Latency from publication by the drive to the reader: measured, without a bound."""
    bridge(quick_robot, *way.options)
    read_until(way, lambda: len(of(way, "joints")) > 3000, "joints are passed on")
    received = way.client.of(way.topic("joints"))
    offset = min(message.at_s - message.json()["t_s"] for message in received)
    ages = sorted(message.at_s - message.json()["t_s"] - offset for message in received)
    print(
        f"MQTT: {len(ages)} samples, later than the quickest by {1000 * ages[len(ages) // 2]:.1f} "
        "ms,"
        f" at most {1000 * ages[-1]:.0f}"
    )


def test_flood_of_commands_stalls_nothing(way: MqttWay, bridge: Start, quick_robot: Robot) -> None:
    """Thousands of commands and replies with samples at 1 kHz, so that input and output wait for
    each other.
    """
    bridge(quick_robot, *way.options, "--allow-commands")
    read_until(way, lambda: of(way, "joints"), "joints are passed on")
    for _ in range(4):
        way.send(*(json.dumps(command(way.robot, "state")).encode() for _ in range(5000)))
        last = quick_robot.state()["t_s"]
        read_until(
            way, lambda last=last: of(way, "joints")[-1]["t_s"] > last, "joints are passed on"
        )
