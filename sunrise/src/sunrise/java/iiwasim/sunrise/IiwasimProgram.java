package iiwasim.sunrise;

import com.kuka.roboticsAPI.applicationModel.RoboticsAPIApplication;
import com.kuka.roboticsAPI.applicationModel.RoboticsAPIApplicationState;
import com.kuka.roboticsAPI.deviceModel.LBR;
import com.kuka.task.ITaskLogger;

import iiwasim.program.KeyFile;
import iiwasim.program.Log;
import iiwasim.program.Program;
import iiwasim.program.Security;
import iiwasim.program.Server;
import iiwasim.program.Settings;

import java.io.IOException;
import java.io.InputStream;
import java.util.ArrayList;
import java.util.List;
import java.util.Random;

/**
 * The robot program of iiwasim: runs the motions and trajectories that a drive requests.
 *
 * <p>A person starts the program on the smartPAD, and the STOP key ends the current run. The
 * program does not begin a motion by itself, and never resumes one after a stop or a pause.
 */
public class IiwasimProgram extends RoboticsAPIApplication {
    private static final String SETTINGS = "iiwasim.settings";
    private static final long LOOK_MS = 100;

    private LBR robot;
    private Settings settings;
    private volatile SunriseBackend backend;
    private volatile Server server;
    private volatile boolean isStopping;

    @Override
    public void initialize() throws Exception {
        robot = getContext().getDeviceFromType(LBR.class);
        settings = Settings.read(resource(SETTINGS), SETTINGS);
    }

    @Override
    public void run() throws Exception {
        try {
            serve();
        } finally {
            // Closes resources that were opened while the program was ending.
            close();
        }
    }

    private void serve() throws Exception {
        if (isStopping) {
            return;
        }
        final ITaskLogger logger = getLogger();
        Log log = new Log() {
            @Override
            public void info(String text) {
                logger.info(text);
            }

            @Override
            public void warn(String text) {
                logger.warn(text);
            }
        };
        log.info(Program.VERSION + " " + settings);
        backend = new SunriseBackend(
            robot, getApplicationControl(), getApplicationData(), settings, log);
        Program program =
            new Program(backend, new Random().nextInt(Integer.MAX_VALUE), new Program.Clock() {
            @Override
            public long nanoTime() {
                return System.nanoTime();
            }
        });
        String at = "tcp://" + settings.address() + ":";
        server = new Server(
            program, at + settings.instructionsPort(), at + settings.statePort(), security(), log);
        backend.openFri(server);
        log.info("waiting for the drive");
        while (!isStopping) {
            if (server.failure() != null) {
                // An unreachable program must not appear to be running.
                throw new IllegalStateException(server.failure());
            }
            Thread.sleep(LOOK_MS);
        }
    }

    /** Frees the ports for the next start; called even after an exception in the methods above. */
    @Override
    public void dispose() throws Exception {
        isStopping = true;
        try {
            close();
        } finally {
            super.dispose();
        }
    }

    private synchronized void close() {
        try {
            if (backend != null) {
                backend.close();
            }
        } finally {
            if (server != null) {
                server.close();
            }
        }
    }

    @Override
    public void onApplicationStateChanged(RoboticsAPIApplicationState state) {
        SunriseBackend current = backend;
        if (state == RoboticsAPIApplicationState.STOPPING) {
            isStopping = true;
        }
        if (current != null && state == RoboticsAPIApplicationState.STOPPING) {
            current.end("the robot program is being ended on the smartPAD");
        } else if (current != null && state == RoboticsAPIApplicationState.MOTIONPAUSING) {
            current.abort(
                "the robot program was paused on the smartPAD; a run does not go on after a pause");
        }
        super.onApplicationStateChanged(state);
    }

    private Security security() throws IOException {
        if (settings.keyFile() == null) {
            return Security.open();
        }
        List<KeyFile> allowed = new ArrayList<KeyFile>();
        for (String file : settings.allowedKeyFiles()) {
            allowed.add(KeyFile.read(resource(file), file));
        }
        return Security.withKeys(
            KeyFile.read(resource(settings.keyFile()), settings.keyFile()), allowed);
    }

    /** A file next to this class. */
    InputStream resource(String name) throws IOException {
        InputStream found = IiwasimProgram.class.getResourceAsStream(name);
        if (found == null) {
            throw new IOException(
                "there is no file " + name + " in the package iiwasim.sunrise of this project;"
                + " put it there and synchronise");
        }
        return found;
    }
}
