package iiwasim.simulation;

import iiwasim.program.Backend;
import iiwasim.program.KeyFile;
import iiwasim.program.Log;
import iiwasim.program.Messages;
import iiwasim.program.Program;
import iiwasim.program.Security;
import iiwasim.program.Server;

import java.io.File;
import java.io.FileInputStream;
import java.io.IOException;
import java.io.PrintStream;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.HashMap;
import java.util.List;
import java.util.Map;
import java.util.Random;

/** The robot program on a PC, with a simulated robot. */
public final class Main {
    private static final String HELP = "usage: java -jar simulated-robot-program.jar [OPTION]...\n"
        + "The robot program of iiwasim in front of a simulated robot, for tests without a "
        + "cabinet.\n\n"
        + "  --instructions ADDRESS          for instructions of the drive "
        + "[tcp://127.0.0.1:30001]\n"
        + "  --state ADDRESS                 for states to the drive [tcp://127.0.0.1:30002]\n"
        + "  --cabinet-instructions ADDRESS  of an `iiwasim cabinet` that simulates the robot;\n"
        + "  --cabinet-state ADDRESS         without it, there is a robot without FRI, which "
        + "stops at each target\n"
        + "  --without-times                 as on a real cabinet: no times of runs, no "
        + "temperatures\n"
        + "  --key FILE.key                  own key, made by `iiwasim keygen`\n"
        + "  --allow FILE|FOLDER             public keys of drives that may connect\n"
        + "  --until-stdin-closes            ends with its parent\n";

    private static final List<String> FLAGS =
        Arrays.asList("--without-times", "--until-stdin-closes");
    private static final List<String> OPTIONS =
        Arrays.asList("--instructions", "--state", "--cabinet-instructions",
        "--cabinet-state", "--key", "--allow");

    private static final long LOOK_MS = 100;

    private Main() {
    }

    /** Runs until the process is killed. The first line on standard output is {@code ready}. */
    public static void main(String[] arguments) throws Exception {
        Map<String, String> options = options(arguments);
        if (options == null) {
            return;
        }
        // JeroMQ prints refused connections to standard output, which the parent process reads.
        PrintStream out = System.out;
        System.setOut(System.err);
        Log log = new Log() {
            @Override
            public void info(String text) {
                System.err.println(text);
            }

            @Override
            public void warn(String text) {
                System.err.println("warning: " + text);
            }
        };
        final Backend backend = backend(options);
        Program program =
            new Program(backend, new Random().nextInt(Integer.MAX_VALUE), new Program.Clock() {
            @Override
            public long nanoTime() {
                return System.nanoTime();
            }
        });
        final Server server = serve(program, options, log);
        Runtime.getRuntime().addShutdownHook(new Thread() {
            @Override
            public void run() {
                server.close();
                backend.close();
            }
        });
        out.println("ready");
        if (options.containsKey("--until-stdin-closes")) {
            while (System.in.read() >= 0) {
                continue;
            }
            System.exit(0);
        }
        while (server.failure() == null) {
            Thread.sleep(LOOK_MS);
        }
        System.exit(1);
    }

    private static Server serve(Program program, Map<String, String> options, Log log) {
        try {
            String instructions = or(options.get("--instructions"), "tcp://127.0.0.1:30001");
            String state = or(options.get("--state"), "tcp://127.0.0.1:30002");
            return new Server(program, instructions, state, security(options), log);
        } catch (IOException error) {
            throw fail(Messages.of(error));
        }
    }

    private static Backend backend(Map<String, String> options) throws InterruptedException {
        boolean isTimed = !options.containsKey("--without-times");
        String instructions = options.get("--cabinet-instructions");
        String state = options.get("--cabinet-state");
        if (instructions == null && state == null) {
            return new SimulatedBackend();
        }
        if (instructions == null || state == null) {
            throw fail("--cabinet-instructions and --cabinet-state belong together");
        }
        CabinetBackend cabinet = new CabinetBackend(instructions, state, isTimed);
        if (!cabinet.awaitConnection(30)) {
            throw fail("the simulated cabinet does not answer; is `iiwasim cabinet` running "
                + "there?");
        }
        return cabinet;
    }

    private static Security security(Map<String, String> options) throws IOException {
        String key = options.get("--key");
        String allow = options.get("--allow");
        if (key == null && allow == null) {
            return Security.open();
        }
        if (key == null || allow == null) {
            throw fail("--key and --allow belong together");
        }
        List<File> files = new ArrayList<File>();
        File allowed = new File(allow);
        if (allowed.isDirectory()) {
            File[] all = allowed.listFiles();
            for (File file : all == null ? new File[0] : all) {
                if (file.getName().endsWith(".pub")) {
                    files.add(file);
                }
            }
        } else {
            files.add(allowed);
        }
        List<KeyFile> keys = new ArrayList<KeyFile>();
        for (File file : files) {
            keys.add(KeyFile.read(new FileInputStream(file), file.getName()));
        }
        return Security.withKeys(
            KeyFile.read(new FileInputStream(key), new File(key).getName()), keys);
    }

    private static Map<String, String> options(String[] arguments) {
        Map<String, String> options = new HashMap<String, String>();
        for (int i = 0; i < arguments.length; i++) {
            String name = arguments[i];
            if (name.equals("--help")) {
                System.out.print(HELP);
                return null;
            }
            if (FLAGS.contains(name)) {
                options.put(name, "");
            } else if (OPTIONS.contains(name) && i + 1 < arguments.length) {
                i++;
                options.put(name, arguments[i]);
            } else {
                throw fail((OPTIONS.contains(name) ? "there is no value after "
                    : "there is no option ") + name + "\n\n" + HELP);
            }
        }
        return options;
    }

    private static String or(String given, String otherwise) {
        return given == null ? otherwise : given;
    }

    /** Ends the program. */
    private static RuntimeException fail(String what) {
        System.err.println("Error: " + what);
        System.exit(2);
        return new IllegalStateException(what);
    }
}
