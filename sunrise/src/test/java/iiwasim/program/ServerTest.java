package iiwasim.program;

import static org.junit.Assert.assertEquals;
import static org.junit.Assert.assertFalse;
import static org.junit.Assert.assertNotNull;
import static org.junit.Assert.assertNull;
import static org.junit.Assert.assertTrue;
import static org.junit.Assert.fail;

import iiwasim.simulation.SimulatedBackend;

import org.junit.After;
import org.junit.Test;
import org.zeromq.ZMQ;

import java.io.ByteArrayInputStream;
import java.io.IOException;
import java.net.InetAddress;
import java.net.ServerSocket;
import java.net.Socket;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.Collections;
import java.util.List;
import java.util.Random;

public class ServerTest {
    static final Log SILENT = new Log() {
        @Override
        public void info(String text) {
            // Not read.
        }

        @Override
        public void warn(String text) {
            // Not read.
        }
    };

    private final SimulatedBackend backend = new SimulatedBackend();
    private final Program program = new Program(backend, 5, new Program.Clock() {
        @Override
        public long nanoTime() {
            return System.nanoTime();
        }
    });

    @After
    public void close() {
        backend.close();
    }

    static String free() throws IOException {
        return "tcp://127.0.0.1:" + Ports.free();
    }

    static KeyFile file(ZMQ.Curve.KeyPair pair, boolean isSecret) throws IOException {
        String text = "# a key\ncurve\n    public-key = \"" + pair.publicKey + "\"\n"
            + (isSecret ? "    secret-key = \"" + pair.secretKey + "\"\n" : "");
        return KeyFile.read(new ByteArrayInputStream(text.getBytes("UTF-8")), "test.key");
    }

    @Test
    public void itStartsAndEndsAgainAndAgain() throws Exception {
        String instructions = free();
        String states = free();
        for (int i = 0; i < 20; i++) {
            Server server = new Server(program, instructions, states, Security.open(), SILENT);
            Peer peer = new Peer(instructions, states, null, null);
            assertEquals("{\"seq\":3}", peer.ask("{\"seq\":3,\"type\":\"stop\"}").toString());
            assertNotNull(peer.state(10));
            peer.close();
            server.close();
            server.close();
        }
        for (Thread thread : Thread.getAllStackTraces().keySet()) {
            assertFalse(thread.getName(), thread.getName().startsWith("iiwasim"));
        }
    }

    @Test
    public void aPortThatIsInUseIsWaitedFor() throws Exception {
        String instructions = free();
        int port = Integer.parseInt(instructions.substring(instructions.lastIndexOf(':') + 1));
        final ServerSocket other = new ServerSocket(port, 1, InetAddress.getByName("127.0.0.1"));
        new Thread() {
            @Override
            public void run() {
                try {
                    Thread.sleep(500);
                    other.close();
                } catch (Exception error) {
                    throw new IllegalStateException(error);
                }
            }
        }.start();
        new Server(program, instructions, free(), Security.open(), SILENT).close();
    }

    @Test
    public void aServerThatFailsSaysSo() throws Exception {
        Program broken = new Program(new ProgramTest.Recorder() {
            @Override
            public Conditions conditions() {
                throw new IllegalStateException("it broke");
            }
        }, 1, new Program.Clock() {
            @Override
            public long nanoTime() {
                return 0;
            }
        });
        String instructions = free();
        String states = free();
        Server server = new Server(broken, instructions, states, Security.open(), SILENT);
        Peer peer = new Peer(instructions, states, null, null);
        long until = System.nanoTime() + 20000000000L;
        while (server.failure() == null && System.nanoTime() < until) {
            Thread.sleep(5);
        }
        assertTrue(server.failure(), server.failure() != null && server.failure()
            .contains("it broke"));
        peer.close();
        server.close();
    }

    @Test
    public void otherMachinesNeedKeys() throws Exception {
        try {
            new Server(program, "tcp://0.0.0.0:1", free(), Security.open(), SILENT);
            fail();
        } catch (IOException error) {
            assertTrue(error.getMessage(), error.getMessage().contains("keys"));
        }
    }

    @Test
    public void onlyKnownKeysAreServed() throws Exception {
        ZMQ.Curve.KeyPair cabinet = ZMQ.Curve.generateKeyPair();
        ZMQ.Curve.KeyPair drive = ZMQ.Curve.generateKeyPair();
        Security security =
            Security.withKeys(file(cabinet, true), Collections.singleton(file(drive, false)));
        String instructions = free();
        String states = free();
        Server server = new Server(program, instructions, states, security, SILENT);
        assertNull(server.peer());
        byte[] serverKey = ZMQ.Curve.z85Decode(cabinet.publicKey);
        // Without a key, with an unknown key, and with the drive key and another server key.
        Peer[] strangers = {
            new Peer(instructions, states, null, null),
            new Peer(instructions, states, serverKey, ZMQ.Curve.generateKeyPair()),
            new Peer(instructions, states,
            ZMQ.Curve.z85Decode(ZMQ.Curve.generateKeyPair().publicKey), drive),
        };
        Peer known = new Peer(instructions, states, serverKey, drive);
        assertEquals("{\"seq\":3}", known.ask("{\"seq\":3,\"type\":\"stop\"}").toString());
        assertNotNull(known.state(10));
        assertEquals("127.0.0.1", server.peer());
        for (Peer stranger : strangers) {
            stranger.send(
                "{\"seq\":4,\"type\":\"set_io\",\"name\":\"MediaFlange.LEDBlue\",\"value\":true}"
                    .getBytes("UTF-8"));
        }
        for (Peer stranger : strangers) {
            assertNull(stranger.answer(0.5));
            assertNull(stranger.state(0.1));
            stranger.close();
        }
        assertTrue(known.ask("{\"seq\":5,\"type\":\"get_io\",\"name\":\"MediaFlange.LEDBlue\"}")
            .toString().contains("false"));
        known.close();
        server.close();
    }

    /** Anyone who can reach a port can send any bytes to it. */
    @Test
    public void strayBytesAreHarmless() throws Exception {
        String instructions = free();
        String states = free();
        Server server = new Server(program, instructions, states, Security.open(), SILENT);
        byte[] greeting = new byte[64];
        greeting[0] = (byte) 0xff;
        greeting[9] = 0x7f;
        greeting[10] = 3;
        byte[] curve = greeting.clone();
        System.arraycopy("CURVE".getBytes("UTF-8"), 0, curve, 12, 5);
        byte[] plain = greeting.clone();
        System.arraycopy("NULL".getBytes("UTF-8"), 0, plain, 12, 4);
        byte[] random = new byte[5000];
        new Random(1).nextBytes(random);
        byte[][] all =
            {new byte[0], "GET / HTTP/1.1\r\n\r\n".getBytes("UTF-8"), random, greeting, curve,
            Arrays.copyOf(plain, 30), plain, Arrays.copyOf(plain, 100), new byte[100000]};
        List<Socket> strays = new ArrayList<Socket>();
        for (String at : new String[] {instructions, states}) {
            int port = Integer.parseInt(at.substring(at.lastIndexOf(':') + 1));
            for (int i = 0; i < all.length; i++) {
                Socket stray = new Socket(InetAddress.getByName("127.0.0.1"), port);
                strays.add(stray);
                try {
                    stray.getOutputStream().write(all[i]);
                    if (i % 2 == 1) {
                        stray.close();
                    }
                } catch (IOException error) {
                    // The server closes the connection.
                }
            }
        }
        Peer peer = new Peer(instructions, states, null, null);
        assertEquals("{\"seq\":3}", peer.ask("{\"seq\":3,\"type\":\"stop\"}").toString());
        assertNotNull(peer.state(10));
        for (Socket stray : strays) {
            stray.close();
        }
        assertEquals("{\"seq\":4}", peer.ask("{\"seq\":4,\"type\":\"stop\"}").toString());
        peer.close();
        server.close();
    }

    @Test
    public void keyFilesThatAreNone() throws Exception {
        ZMQ.Curve.KeyPair pair = ZMQ.Curve.generateKeyPair();
        for (String text : new String[] {"", "public-key = abc", "public-key = \"abc\"",
            "public-key = \"" + pair.publicKey.substring(1) + "~\""}) {
            try {
                KeyFile.read(new ByteArrayInputStream(text.getBytes("UTF-8")), "bad.key");
                fail(text);
            } catch (IOException error) {
                assertTrue(error.getMessage(), error.getMessage().contains("bad.key"));
                assertFalse(error.getMessage(), error.getMessage().contains("abc"));
            }
        }
        try {
            Security.withKeys(file(pair, false), Collections.singleton(file(pair, false)));
            fail();
        } catch (IOException error) {
            assertTrue(error.getMessage(), error.getMessage().contains("secret"));
        }
        try {
            Security.withKeys(file(pair, true), Collections.singleton(file(pair, true)));
            fail();
        } catch (IOException error) {
            assertTrue(error.getMessage(), error.getMessage().contains(".pub"));
        }
    }
}
