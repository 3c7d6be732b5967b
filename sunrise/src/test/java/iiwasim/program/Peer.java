package iiwasim.program;

import com.eclipsesource.json.Json;
import com.eclipsesource.json.JsonValue;

import org.zeromq.ZMQ;
import org.zeromq.ZMQException;

import java.nio.charset.Charset;
import java.util.concurrent.BlockingQueue;
import java.util.concurrent.LinkedBlockingQueue;
import java.util.concurrent.TimeUnit;

/** A drive from the view of a robot program: a socket for instructions, and one for states. */
final class Peer {
    static final Charset UTF_8 = Charset.forName("UTF-8");
    private static final int POLL_MS = 20;

    final BlockingQueue<JsonValue> states = new LinkedBlockingQueue<JsonValue>();
    /** The answer to states; null to send no answer. */
    volatile String acknowledgement = "{\"ok\":true}";
    private final ZMQ.Context context = ZMQ.context(1);
    private final ZMQ.Socket instructions;
    private final Thread receiver;
    private volatile boolean isClosing;

    /** Connects, with the key pair {@code own} if given. */
    Peer(String instructionsAt, String statesAt, byte[] serverKey, ZMQ.Curve.KeyPair own) {
        instructions = socket(ZMQ.DEALER, instructionsAt, serverKey, own);
        // DEALER, as REP has to answer.
        final ZMQ.Socket socket = socket(ZMQ.DEALER, statesAt, serverKey, own);
        receiver = new Thread() {
            @Override
            public void run() {
                receive(socket);
            }
        };
        receiver.start();
    }

    private ZMQ.Socket socket(int type, String at, byte[] serverKey, ZMQ.Curve.KeyPair own) {
        ZMQ.Socket socket = context.socket(type);
        socket.setLinger(0);
        socket.setReceiveTimeOut(POLL_MS);
        if (own != null) {
            socket.setCurveServerKey(serverKey);
            socket.setCurvePublicKey(ZMQ.Curve.z85Decode(own.publicKey));
            socket.setCurveSecretKey(ZMQ.Curve.z85Decode(own.secretKey));
        }
        socket.connect(at);
        return socket;
    }

    private void receive(ZMQ.Socket socket) {
        try {
            while (!isClosing) {
                byte[] frame = socket.recv();
                while (frame != null && socket.hasReceiveMore()) {
                    frame = socket.recv();
                }
                String answer = acknowledgement;
                if (frame != null) {
                    states.add(Json.parse(new String(frame, UTF_8)));
                }
                if (frame != null && answer != null) {
                    socket.send("", ZMQ.SNDMORE);
                    socket.send(answer);
                }
            }
        } catch (ZMQException error) {
            isClosing = true;
        } finally {
            socket.close();
        }
    }

    void send(byte[]... body) {
        instructions.send("", ZMQ.SNDMORE);
        for (int i = 0; i < body.length; i++) {
            instructions.send(body[i], i + 1 < body.length ? ZMQ.SNDMORE : 0);
        }
    }

    /** The next answer; null after a timeout. */
    JsonValue answer(double withinS) {
        long until = System.nanoTime() + (long) (withinS * 1e9);
        do {
            byte[] frame = instructions.recv();
            while (frame != null && instructions.hasReceiveMore()) {
                frame = instructions.recv();
            }
            if (frame != null) {
                return Json.parse(new String(frame, UTF_8));
            }
        } while (System.nanoTime() < until);
        return null;
    }

    JsonValue ask(String instruction) {
        send(instruction.getBytes(UTF_8));
        return answer(10);
    }

    /** The next state; null after a timeout. */
    JsonValue state(double withinS) throws InterruptedException {
        return states.poll((long) (withinS * 1e3), TimeUnit.MILLISECONDS);
    }

    void close() throws InterruptedException {
        isClosing = true;
        receiver.join();
        instructions.close();
        context.term();
    }
}
