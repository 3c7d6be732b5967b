package iiwasim.sunrise;

// In Sunrise 1.7 to 1.10, these classes are in com.kuka.connectivity.fri. Only this file uses FRI.
import com.kuka.connectivity.fastRobotInterface.ClientCommandMode;
import com.kuka.connectivity.fastRobotInterface.FRIChannelInformation;
import com.kuka.connectivity.fastRobotInterface.FRIChannelInformation.FRISessionState;
import com.kuka.connectivity.fastRobotInterface.FRIConfiguration;
import com.kuka.connectivity.fastRobotInterface.FRIJointOverlay;
import com.kuka.connectivity.fastRobotInterface.FRISession;
import com.kuka.roboticsAPI.deviceModel.LBR;

import iiwasim.program.Log;
import iiwasim.program.Messages;
import iiwasim.program.Refusal;
import iiwasim.program.Server;
import iiwasim.program.Settings;

import java.util.concurrent.TimeUnit;
import java.util.concurrent.TimeoutException;

/**
 * Keeps an FRI session open for permanent monitoring: opens it, waits for the client, and reopens
 * it whenever it has ended.
 */
final class FriKeeper {
    private static final long AWAIT_S = 10;
    private static final long LOOK_MS = 500;
    private static final long CLIENT_MS = 200;

    /**
     * Pause before a new session: an ended session takes five seconds to close, and a new one fails
     * until then.
     */
    private static final long DIES_MS = 6000;

    private final LBR robot;
    private final Settings settings;
    private final Log log;
    private Thread thread;
    private FRISession session;
    private volatile String told = "";
    private volatile boolean isClosing;

    FriKeeper(LBR robot, Settings settings, Log log) {
        this.robot = robot;
        this.settings = settings;
        this.log = log;
    }

    void start(final Server server) {
        thread = new Thread(new Runnable() {
            @Override
            public void run() {
                keep(server);
            }
        }, "iiwasim FRI");
        thread.setDaemon(true);
        thread.start();
    }

    private void keep(Server server) {
        try {
            while (!isClosing) {
                String client = client(server);
                try {
                    if (open(client)) {
                        while (isOpen() && client.equals(client(server))) {
                            Thread.sleep(LOOK_MS);
                        }
                        tell("FRI has ended; it is opened again");
                    }
                } catch (RuntimeException error) {
                    tell("FRI cannot be opened: " + Messages.of(error));
                }
                closeSession();
                Thread.sleep(DIES_MS);
            }
        } catch (InterruptedException interrupt) {
            // The program ends.
        } finally {
            closeSession();
        }
    }

    /** Address of the FRI client; waits for the drive if the drive is the client. */
    private String client(Server server) throws InterruptedException {
        if (!settings.friClient().equals(Settings.DRIVE)) {
            return settings.friClient();
        }
        String peer = server.peer();
        while (peer == null) {
            Thread.sleep(CLIENT_MS);
            peer = server.peer();
        }
        return peer;
    }

    private boolean open(String client) throws InterruptedException {
        FRIConfiguration configuration = FRIConfiguration.createRemoteConfiguration(robot, client);
        configuration.setPortOnRemote(settings.friPort());
        configuration.setSendPeriodMilliSec(settings.friPeriodMs());
        configuration.setReceiveMultiplier(settings.friReceiveMultiplier());
        FRISession opened = new FRISession(configuration);
        synchronized (this) {
            session = opened;
        }
        try {
            opened.await(AWAIT_S, TimeUnit.SECONDS);
        } catch (TimeoutException late) {
            tell("FRI: nothing answers at " + client + ":" + settings.friPort() + " within "
                + AWAIT_S
                + " s; is the drive running there, and do fri_client and the netmask fit? Trying "
                + "on.");
            return false;
        }
        tell("FRI is open to " + client + ":" + settings.friPort());
        return true;
    }

    private synchronized FRIChannelInformation information() {
        return session == null ? null : session.getFRIChannelInformation();
    }

    private boolean isOpen() {
        FRIChannelInformation information = information();
        return !isClosing && information != null
            && information.getFRISessionState() != FRISessionState.IDLE;
    }

    /** Fails if commanding cannot begin. */
    void checkReady() throws Refusal {
        FRIChannelInformation information = information();
        if (information == null || information.getFRISessionState()
            .compareTo(FRISessionState.MONITORING_READY) < 0) {
            throw Refusal.robot("FRI is not ready for commanding: " + state());
        }
    }

    boolean isActive() {
        FRIChannelInformation information = information();
        return information != null
            && information.getFRISessionState() == FRISessionState.COMMANDING_ACTIVE;
    }

    /** State of the session, for people. */
    String state() {
        FRIChannelInformation information = information();
        if (information == null) {
            return "no session is open";
        }
        return "session " + information.getFRISessionState() + ", quality "
            + information.getQuality();
    }

    /** Motion overlay of the set-points. */
    synchronized FRIJointOverlay overlay() {
        return new FRIJointOverlay(session, ClientCommandMode.POSITION);
    }

    /** Logs a text once, and not at each attempt. */
    private void tell(String text) {
        if (!text.equals(told)) {
            told = text;
            log.info(text);
        }
    }

    private void closeSession() {
        FRISession closing;
        synchronized (this) {
            closing = session;
            session = null;
        }
        try {
            if (closing != null) {
                closing.close();
            }
        } catch (RuntimeException error) {
            tell("FRI cannot be closed: " + Messages.of(error));
        }
    }

    void close() {
        isClosing = true;
        if (thread != null) {
            thread.interrupt();
            Run.join(thread);
        }
    }
}
