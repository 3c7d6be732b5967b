package iiwasim.sunrise;

import static org.junit.Assert.assertEquals;
import static org.junit.Assert.assertTrue;
import static org.junit.Assert.fail;

import com.kuka.connectivity.fastRobotInterface.FRISession;
import com.kuka.roboticsAPI.applicationModel.RoboticsAPIApplication;
import com.kuka.roboticsAPI.applicationModel.RoboticsAPIApplicationState;
import com.kuka.roboticsAPI.applicationModel.RoboticsContext;
import com.kuka.task.ITaskLogger;

import iiwasim.program.Ports;

import org.junit.After;
import org.junit.Before;
import org.junit.Test;
import org.zeromq.ZMQ;

import java.io.ByteArrayInputStream;
import java.io.IOException;
import java.io.InputStream;
import java.net.InetAddress;
import java.net.ServerSocket;
import java.net.Socket;
import java.util.Collections;
import java.util.HashMap;
import java.util.HashSet;
import java.util.Map;
import java.util.Set;

/** The application, started and ended as on a cabinet, whose JVM outlives it, with a stub robot. */
public class IiwasimProgramTest {
    private static final long LONG_MS = 20000;

    private final FakeRobot robot = new FakeRobot();
    /** The files next to the application. */
    private final Map<String, String> files = new HashMap<String, String>();
    private final int[] ports = new int[2];
    private volatile Exception failure;

    @Before
    public void prepare() throws IOException {
        RoboticsAPIApplication.context = new RoboticsContext() {
            @Override
            public <T> T getDeviceFromType(Class<T> type) {
                return type.cast(robot);
            }
        };
        RoboticsAPIApplication.control = robot;
        RoboticsAPIApplication.data = robot;
        RoboticsAPIApplication.logger = new ITaskLogger() {
            @Override
            public void info(String text) {
                // Not read.
            }

            @Override
            public void warn(String text) {
                // Not read.
            }

            @Override
            public void error(String text) {
                // Not read.
            }
        };
        for (int i = 0; i < 2; i++) {
            ports[i] = Ports.free();
        }
        ZMQ.Curve.KeyPair cabinet = ZMQ.Curve.generateKeyPair();
        files.put("cabinet.key", "public-key = \"" + cabinet.publicKey + "\"\nsecret-key = \""
            + cabinet.secretKey + "\"\n");
        files.put("drive.pub", "public-key = \"" + ZMQ.Curve.generateKeyPair().publicKey + "\"\n");
        files.put("iiwasim.settings", "address = 127.0.0.1\ninstructions_port = " + ports[0]
            + "\nstate_port = " + ports[1]
            + "\nkey = cabinet.key\nallow = drive.pub\nfri_client = 10.0.0.5\n");
    }

    @After
    public void forget() {
        RoboticsAPIApplication.context = null;
        RoboticsAPIApplication.control = null;
        RoboticsAPIApplication.data = null;
        RoboticsAPIApplication.logger = null;
    }

    private static ServerSocket open(int port) throws IOException {
        return new ServerSocket(port, 1, InetAddress.getByName("127.0.0.1"));
    }

    private IiwasimProgram application() {
        return new IiwasimProgram() {
            @Override
            InputStream resource(String name) throws IOException {
                String text = files.get(name);
                return text == null ? super.resource(name)
                    : new ByteArrayInputStream(text.getBytes("UTF-8"));
            }
        };
    }

    private Thread run(final IiwasimProgram application) {
        Thread thread = new Thread("application") {
            @Override
            public void run() {
                try {
                    application.run();
                } catch (InterruptedException interrupt) {
                    // The cabinet also ends the application after an exception.
                } catch (Exception error) {
                    failure = error;
                }
            }
        };
        thread.start();
        return thread;
    }

    private Socket connected(int port) throws Exception {
        long until = System.nanoTime() + LONG_MS * 1000000;
        while (true) {
            try {
                return new Socket(InetAddress.getByName("127.0.0.1"), port);
            } catch (IOException refused) {
                assertTrue("nothing listens; " + failure, System.nanoTime() < until);
                Thread.sleep(2);
            }
        }
    }

    private static Set<Thread> threads() {
        return new HashSet<Thread>(Thread.getAllStackTraces().keySet());
    }

    /** New threads since {@code before}. */
    private static Set<Thread> left(Set<Thread> before) throws InterruptedException {
        Set<Thread> left = Collections.emptySet();
        long until = System.nanoTime() + LONG_MS * 1000000;
        do {
            left = threads();
            left.removeAll(before);
            Thread.sleep(5);
        } while (!left.isEmpty() && System.nanoTime() < until);
        return left;
    }

    @Test
    public void aHundredStartsLeaveNoPortAndNoThread() throws Exception {
        Set<Thread> before = threads();
        for (int i = 0; i < 100; i++) {
            IiwasimProgram application = application();
            application.initialize();
            Thread running = run(application);
            Socket[] peers = {connected(ports[0]), connected(ports[1])};
            if (i % 2 == 0) {
                peers[0].close();
            }
            if (i % 3 == 0) {
                application.onApplicationStateChanged(RoboticsAPIApplicationState.STOPPING);
            } else if (i % 3 == 1) {
                running.interrupt();
            }
            application.dispose();
            running.join(LONG_MS);
            for (int port : ports) {
                open(port).close();
            }
            peers[0].close();
            peers[1].close();
            assertEquals("start " + i, Collections.emptySet(), left(before));
        }
        assertEquals(null, failure);
        int opened = Collections.frequency(FRISession.CALLS, "open 10.0.0.5:30200");
        int closed = Collections.frequency(FRISession.CALLS, "close");
        assertEquals(opened, closed);
    }

    @Test
    public void whatIsWrongEndsItAndLeavesNothing() throws Exception {
        Set<Thread> before = threads();
        String settings = files.get("iiwasim.settings");
        String[][] cases = {
            {settings + "velocity = 3\n", "line 7"},
            {settings.replace("drive.pub", "nobody.pub"), "nobody.pub"},
            {settings.replace("key = cabinet.key", "key = drive.pub"), "secret"},
        };
        for (String[] row : cases) {
            files.put("iiwasim.settings", row[0]);
            IiwasimProgram application = application();
            try {
                application.initialize();
                application.run();
                fail(row[1]);
            } catch (IOException error) {
                assertTrue(error.getMessage(), error.getMessage().contains(row[1]));
            } finally {
                application.dispose();
            }
            assertEquals(row[1], Collections.emptySet(), left(before));
        }
        // Also without a start.
        application().dispose();
    }
}
