package iiwasim.program;

import org.zeromq.ZMQ;
import org.zeromq.ZMQException;

import java.io.IOException;
import java.nio.ByteBuffer;
import java.nio.charset.CharacterCodingException;
import java.nio.charset.Charset;
import java.util.ArrayList;
import java.util.List;

/**
 * The sockets of the robot program (Larsen 2019, section 3.1.1).
 *
 * <table>
 * <tr><th>thread</th><th>task</th></tr>
 * <tr><td>instructions</td><td>acknowledges instructions; the only caller of the backend</td></tr>
 * <tr><td>states</td><td>sends the state until it is acknowledged</td></tr>
 * <tr><td>gate</td><td>checks keys, if configured</td></tr>
 * </table>
 *
 * <p>The server does not have static state, and {@link #close()} ends all of it: the JVM of a
 * cabinet outlives the program.
 */
public final class Server {
    static final int POLL_MS = 50;

    /** Longest instruction, in bytes: twice the longest instruction of a drive. */
    private static final int MAX_INSTRUCTION_BYTES = 8 << 20;
    private static final int MAX_ACKNOWLEDGEMENT_BYTES = 1024;

    private static final int STATES_KEPT = 10;

    /**
     * Intervals for polling the state, repeating a message and sending an unchanged state, in ms.
     */
    private static final int LOOK_MS = 2;
    private static final int AGAIN_MS = 100;
    private static final int EVERY_MS = 500;

    /** Maximum time for which a program that is ending may still use the ports, in ms. */
    private static final int BIND_WITHIN_MS = 10000;
    private static final int BIND_AGAIN_MS = 200;

    /** Maximum time for threads to end, in ms: the controller may still execute an instruction. */
    private static final int JOIN_MS = 5000;

    private final Program program;
    private final Log log;
    private final ZMQ.Context context = ZMQ.context(1);
    private final List<Thread> threads = new ArrayList<Thread>();
    private Gate gate;
    private volatile boolean isClosing;
    private volatile String failure;

    /**
     * Starts the server.
     *
     * @param instructions the address for instructions, such as {@code tcp://0.0.0.0:30001}
     * @param states the address for states
     * @throws IOException an address requires keys, or cannot be bound within ten seconds
     */
    public Server(Program program, String instructions, String states, Security security, Log log)
        throws IOException {
        this.program = program;
        this.log = log;
        boolean isStarted = false;
        try {
            checkAddress(instructions, security);
            checkAddress(states, security);
            if (security.hasKeys()) {
                gate = new Gate(context, security, log);
                start("iiwasim gate", gate);
            }
            final ZMQ.Socket rep = bound(ZMQ.REP, instructions, security, MAX_INSTRUCTION_BYTES);
            start("iiwasim instructions", new Runnable() {
                @Override
                public void run() {
                    serve(rep);
                }
            });
            final ZMQ.Socket dealer =
                bound(ZMQ.DEALER, states, security, MAX_ACKNOWLEDGEMENT_BYTES);
            start("iiwasim states", new Runnable() {
                @Override
                public void run() {
                    sendStates(dealer);
                }
            });
            isStarted = true;
        } finally {
            if (!isStarted) {
                close();
            }
        }
    }

    /** Address of the drive that connected last; null before the first one, and without keys. */
    public String peer() {
        return gate == null ? null : gate.peer();
    }

    /** Ends all threads and frees the ports. Further calls are allowed. */
    public synchronized void close() {
        isClosing = true;
        if (gate != null) {
            gate.close();
        }
        boolean haveEnded = true;
        for (Thread thread : threads) {
            haveEnded &= Threads.join(thread, JOIN_MS);
        }
        threads.clear();
        if (haveEnded) {
            // JeroMQ does not wait in an interrupted thread.
            boolean wasInterrupted = Thread.interrupted();
            context.term();
            if (wasInterrupted) {
                Thread.currentThread().interrupt();
            }
        } else {
            log.warn("a thread of the robot program is still waiting for the controller");
        }
    }

    private void start(String name, Runnable task) {
        Thread thread = new Thread(task, name);
        thread.setDaemon(true);
        threads.add(thread);
        thread.start();
    }

    private static void checkAddress(String address, Security security) throws IOException {
        if (!security.hasKeys() && !address.startsWith("tcp://127.0.0.1:")) {
            throw new IOException(
                address + " can be reached from other machines, which requires keys;"
                + " without keys, only tcp://127.0.0.1 is served");
        }
    }

    private ZMQ.Socket bound(int type, String address, Security security, long maxBytes)
        throws IOException {
        ZMQ.Socket socket = context.socket(type);
        boolean isBound = false;
        try {
            socket.setLinger(0);
            if (type == ZMQ.DEALER) {
                // Old states are not queued for a drive that has disconnected.
                socket.setSndHWM(STATES_KEPT);
            }
            socket.setMaxMsgSize(maxBytes);
            socket.setReceiveTimeOut(POLL_MS);
            if (security.hasKeys()) {
                socket.setCurveServer(true);
                socket.setCurvePublicKey(security.own().publicKey());
                socket.setCurveSecretKey(security.own().secretKey());
                socket.setZAPDomain(Gate.DOMAIN);
            }
            long until = System.nanoTime() + BIND_WITHIN_MS * 1000000L;
            String problem = bind(socket, address);
            while (problem != null && System.nanoTime() < until) {
                pause(BIND_AGAIN_MS);
                problem = bind(socket, address);
            }
            if (problem != null) {
                throw new IOException("cannot listen at " + address + ": " + problem);
            }
            isBound = true;
            return socket;
        } finally {
            if (!isBound) {
                socket.close();
            }
        }
    }

    private static String bind(ZMQ.Socket socket, String address) {
        try {
            return socket.bind(address) ? null : "the port is in use";
        } catch (ZMQException error) {
            return Messages.of(error);
        }
    }

    private void serve(ZMQ.Socket socket) {
        try {
            while (!isClosing) {
                byte[] first = socket.recv();
                if (first == null) {
                    continue;
                }
                List<String> frames = new ArrayList<String>();
                frames.add(text(first));
                while (socket.hasReceiveMore()) {
                    frames.add(text(socket.recv()));
                }
                socket.send(bytes(program.instruct(frames)));
            }
        } catch (RuntimeException error) {
            ended(error);
        } finally {
            socket.close();
        }
    }

    private void sendStates(ZMQ.Socket socket) {
        try {
            long sent = -1;
            long sentAt = 0;
            boolean isAcknowledged = false;
            while (!isClosing) {
                while (socket.recv(ZMQ.DONTWAIT) != null) {
                    isAcknowledged = true;
                }
                long changes = program.changes();
                long waited = (System.nanoTime() - sentAt) / 1000000;
                if (changes != sent || waited >= (isAcknowledged ? EVERY_MS : AGAIN_MS)) {
                    sent = changes;
                    sentAt = System.nanoTime();
                    isAcknowledged = false;
                    if (socket.send("", ZMQ.SNDMORE | ZMQ.DONTWAIT)) {
                        socket.send(bytes(program.state()), ZMQ.DONTWAIT);
                    }
                }
                pause(LOOK_MS);
            }
        } catch (RuntimeException error) {
            ended(error);
        } finally {
            socket.close();
        }
    }

    private void ended(RuntimeException error) {
        if (!isClosing) {
            failure = "the connection to the drive has failed: " + Messages.of(error);
            log.warn(failure);
        }
    }

    /** Reason for the failure of the server; null while it runs. */
    public String failure() {
        return failure;
    }

    private static void pause(int milliseconds) {
        try {
            Thread.sleep(milliseconds);
        } catch (InterruptedException interrupt) {
            Thread.currentThread().interrupt();
        }
    }

    /** The text of a frame; null if it is not UTF-8. */
    private static String text(byte[] frame) {
        try {
            return Charset.forName("UTF-8").newDecoder().decode(ByteBuffer.wrap(frame)).toString();
        } catch (CharacterCodingException error) {
            return null;
        }
    }

    private static byte[] bytes(String text) {
        return text.getBytes(Charset.forName("UTF-8"));
    }
}
