package iiwasim.program;

import org.zeromq.ZMQ;
import org.zeromq.ZMQException;

import java.util.ArrayList;
import java.util.List;

/**
 * Authenticates drives by their keys with ZAP (ZeroMQ RFC 27). Without ZAP, everyone with the
 * public key of the server would be admitted, so the gate has to run before any socket is bound.
 */
final class Gate implements Runnable {
    static final String DOMAIN = "iiwasim";
    private static final int KEY_BYTES = 32;

    private final ZMQ.Socket socket;
    private final Security security;
    private final Log log;
    private volatile boolean isClosing;
    private volatile String peer;
    private String refused = "";

    Gate(ZMQ.Context context, Security security, Log log) {
        this.security = security;
        this.log = log;
        socket = context.socket(ZMQ.REP);
        socket.setLinger(0);
        socket.setReceiveTimeOut(Server.POLL_MS);
        socket.bind("inproc://zeromq.zap.01");
    }

    @Override
    public void run() {
        try {
            while (!isClosing) {
                byte[] first = socket.recv();
                if (first != null) {
                    answer(first);
                }
            }
        } catch (ZMQException error) {
            if (!isClosing) {
                log.warn("keys can no longer be checked: " + Messages.of(error));
            }
        } finally {
            socket.close();
        }
    }

    void close() {
        isClosing = true;
    }

    /** The address of the drive that was admitted last; null before the first one. */
    String peer() {
        return peer;
    }

    private void answer(byte[] version) {
        List<byte[]> frames = new ArrayList<byte[]>();
        frames.add(version);
        while (socket.hasReceiveMore()) {
            frames.add(socket.recv());
        }
        // Version, request, domain, address, identity, mechanism, key.
        boolean isComplete = frames.size() >= 6;
        String address = isComplete ? Messages.excerpt(new String(frames.get(3))) : "";
        byte[] key = frames.size() == 7 ? frames.get(6) : new byte[0];
        boolean isAdmitted = isComplete && new String(frames.get(2)).equals(DOMAIN)
            && new String(frames.get(5)).equals("CURVE") && key.length == KEY_BYTES
            && security.admits(key);
        if (isAdmitted) {
            if (!address.equals(peer)) {
                log.info("a drive at " + address + " connects");
            }
            peer = address;
        } else if (!refused.equals(address)) {
            // A client without a permitted key retries endlessly.
            refused = address;
            log.warn("a client at " + address + " has no permitted key and is refused");
        }
        socket.send("1.0", ZMQ.SNDMORE);
        socket.send(isComplete ? frames.get(1) : new byte[0], ZMQ.SNDMORE);
        socket.send(isAdmitted ? "200" : "400", ZMQ.SNDMORE);
        socket.send(isAdmitted ? "OK" : "the key is not permitted", ZMQ.SNDMORE);
        socket.send("", ZMQ.SNDMORE);
        socket.send("");
    }
}
