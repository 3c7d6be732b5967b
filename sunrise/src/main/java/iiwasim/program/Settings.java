package iiwasim.program;

import java.io.BufferedReader;
import java.io.IOException;
import java.io.InputStream;
import java.io.InputStreamReader;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.Collections;
import java.util.HashMap;
import java.util.LinkedHashMap;
import java.util.List;
import java.util.Map;

/**
 * Settings of the robot program: lines {@code name = value}, with comments from {@code #} on.
 * Missing settings have defaults. Every invalid or unknown setting is refused with its line, as an
 * ignored setting may be the one that matters.
 */
public final class Settings {
    /** Value of the FRI client setting for the address of the connected drive. */
    public static final String DRIVE = "drive";

    /** Types of signals. */
    public enum SignalType { BOOLEAN, INTEGER, UNSIGNED, ANALOG }

    /** A declared input or output. */
    public static final class DeclaredSignal {
        public final String group;
        public final String name;
        public final boolean isOutput;
        public final SignalType type;
        /** Size, in bits. */
        public final int bits;
        /** The range of an analog output. */
        public final double min;
        public final double max;

        DeclaredSignal(String group, String name, boolean isOutput, SignalType type, int bits,
            double min, double max) {
            this.group = group;
            this.name = name;
            this.isOutput = isOutput;
            this.type = type;
            this.bits = bits;
            this.min = min;
            this.max = max;
        }
    }

    private static final Map<String, String> DEFAULTS = new HashMap<String, String>();

    static {
        DEFAULTS.put("address", "0.0.0.0");
        DEFAULTS.put("instructions_port", "30001");
        DEFAULTS.put("state_port", "30002");
        DEFAULTS.put("key", "");
        DEFAULTS.put("allow", "");
        DEFAULTS.put("fri_client", DRIVE);
        DEFAULTS.put("fri_port", "30200");
        DEFAULTS.put("fri_period_ms", "5");
        DEFAULTS.put("fri_receive_multiplier", "1");
        DEFAULTS.put("tool", "");
        DEFAULTS.put("batch", "100");
        DEFAULTS.put("sunrise", "");
        DEFAULTS.put("robot", "");
        DEFAULTS.put("flange_mm", "");
    }

    private final Map<String, String> values = new LinkedHashMap<String, String>();
    private final Map<String, Integer> lines = new HashMap<String, Integer>();
    private final List<DeclaredSignal> signals = new ArrayList<DeclaredSignal>();
    private final String file;

    private Settings(String file) {
        this.file = file;
    }

    /**
     * Reads settings, and closes them.
     *
     * @param file name of the settings file, for messages
     * @throws IOException the settings cannot be read, or one of them is invalid
     */
    public static Settings read(InputStream in, String file) throws IOException {
        Settings settings = new Settings(file);
        BufferedReader reader = new BufferedReader(new InputStreamReader(in, "UTF-8"));
        try {
            int number = 0;
            for (String line = reader.readLine(); line != null; line = reader.readLine()) {
                number++;
                int comment = line.indexOf('#');
                String content = (comment < 0 ? line : line.substring(0, comment)).trim();
                if (content.length() > 0) {
                    settings.readLine(content, number);
                }
            }
        } finally {
            reader.close();
        }
        settings.check();
        return settings;
    }

    private void readLine(String content, int number) throws IOException {
        int equals = content.indexOf('=');
        if (equals < 0) {
            throw wrong(number, "`" + Messages.excerpt(content)
                + "` is not of the form `name = value`");
        }
        String name = content.substring(0, equals).trim();
        String value = content.substring(equals + 1).trim();
        if (lines.containsKey(name)) {
            throw wrong(number, "`" + name + "` is already set, at line " + lines.get(name));
        }
        lines.put(name, number);
        if (name.startsWith("input.") || name.startsWith("output.")) {
            signals.add(signal(name, value, number));
        } else if (DEFAULTS.containsKey(name)) {
            values.put(name, value);
        } else {
            throw wrong(number, "unknown setting `" + Messages.excerpt(name) + "`");
        }
    }

    /**
     * An input or output: {@code output.GROUP.NAME = boolean}, {@code unsigned 8} or {@code analog
     * 16 0 10}.
     */
    private DeclaredSignal signal(String key, String value, int number) throws IOException {
        String[] path = key.split("\\.", 3);
        String[] words = value.split("\\s+");
        if (path.length < 3 || path[1].length() == 0 || path[2].length() == 0) {
            throw wrong(number, "`" + Messages.excerpt(key)
                + "` is not of the form `input.GROUP.NAME`");
        }
        boolean isOutput = path[0].equals("output");
        List<String> types = Arrays.asList("boolean", "integer", "unsigned", "analog");
        int index = types.indexOf(words[0]);
        boolean hasRange = isOutput && index == 3;
        if (index < 0 || words.length != (index == 0 ? 1 : hasRange ? 4 : 2)) {
            throw wrong(number, "`" + Messages.excerpt(value)
                + "` is not a type; it is `boolean`, `integer BITS`,"
                + " `unsigned BITS`, `analog BITS`, or of an output `analog BITS LEAST GREATEST`");
        }
        try {
            int bits = index == 0 ? 1 : Integer.parseInt(words[1]);
            double min = hasRange ? Double.parseDouble(words[2]) : 0;
            double max = hasRange ? Double.parseDouble(words[3]) : 0;
            if (bits < 1 || bits > 64 || hasRange && !(min < max)) {
                throw wrong(number, "bits are from 1 to 64, and a range goes upwards");
            }
            return new DeclaredSignal(
                path[1], path[2], isOutput, SignalType.values()[index], bits, min, max);
        } catch (NumberFormatException error) {
            throw wrong(number, "`" + Messages.excerpt(value)
                + "` has something that is not a number");
        }
    }

    private void check() throws IOException {
        whole("instructions_port", 1, 65535);
        whole("state_port", 1, 65535);
        whole("fri_port", 30200, 30209);
        whole("fri_period_ms", 1, 100);
        whole("fri_receive_multiplier", 1, 100);
        whole("batch", 1, 5000);
        if (instructionsPort() == statePort()) {
            throw wrong("state_port", "`state_port` has to differ from `instructions_port`");
        }
        if (friPeriodMs() > 10) {
            int product = friPeriodMs() * friReceiveMultiplier();
            if (product > 100) {
                throw wrong("fri_period_ms",
                    "an answer is due at least every 100 ms: period times multiplier");
            }
        }
        if ((text("robot").length() == 0) != (text("flange_mm").length() == 0)) {
            throw wrong(text("robot").length() == 0 ? "flange_mm" : "robot",
                "`robot` and `flange_mm` belong together");
        }
        if (text("robot").length() > 0) {
            if (RobotIdentity.of(text("robot"), 0) == null) {
                throw wrong("robot", "`robot` is `" + Messages.excerpt(text("robot"))
                    + "`; it has to be " + RobotIdentity.MODELS);
            }
            checkFlange();
        }
        for (String name : new String[] {"address", "fri_client"}) {
            if (!isAddress(text(name))
                && !(name.equals("fri_client") && text(name).equals(DRIVE))) {
                throw wrong(name, "`" + name + "` is `" + Messages.excerpt(text(name))
                    + "`; it has to be an IPv4 address such as 172.31.1.100");
            }
        }
        if ((text("key").length() == 0) != (text("allow").length() == 0)) {
            throw wrong(text("key").length() == 0 ? "allow" : "key",
                "`key` and `allow` belong together");
        }
    }

    private void checkFlange() throws IOException {
        try {
            double flangeMm = Double.parseDouble(text("flange_mm"));
            if (flangeMm > 0 && flangeMm <= 10000) {
                return;
            }
        } catch (NumberFormatException error) {
            // Reported below.
        }
        throw wrong("flange_mm", "`flange_mm` is `" + Messages.excerpt(text("flange_mm"))
            + "`; it has to be a length in mm, such as 126 for the plain flange or 152 for the "
            + "media flange Touch");
    }

    /**
     * True for an IP address. Host names are refused: they may resolve to an unreachable IPv6
     * address.
     */
    private static boolean isAddress(String text) {
        if (!text.matches("\\d{1,3}(\\.\\d{1,3}){3}")) {
            return false;
        }
        for (String part : text.split("\\.")) {
            if (Integer.parseInt(part) > 255) {
                return false;
            }
        }
        return true;
    }

    private int whole(String name, int min, int max) throws IOException {
        try {
            int value = Integer.parseInt(text(name));
            if (value >= min && value <= max) {
                return value;
            }
        } catch (NumberFormatException error) {
            // Reported below.
        }
        throw wrong(name, "`" + name + "` is `" + Messages.excerpt(text(name))
            + "`; it has to be a whole number from " + min
            + " to " + max);
    }

    private IOException wrong(String name, String what) {
        return wrong(lines.containsKey(name) ? lines.get(name) : 0, what);
    }

    private IOException wrong(int line, String what) {
        return new IOException(file + (line == 0 ? "" : ", line " + line) + ": " + what);
    }

    private String text(String name) {
        String value = values.get(name);
        return value == null ? DEFAULTS.get(name) : value;
    }

    private int number(String name) {
        return Integer.parseInt(text(name));
    }

    /** Listening address: 127.0.0.1 without keys. */
    public String address() {
        return keyFile() == null ? "127.0.0.1" : text("address");
    }

    public int instructionsPort() {
        return number("instructions_port");
    }

    public int statePort() {
        return number("state_port");
    }

    /** File with the secret key of this program; null without keys. */
    public String keyFile() {
        return text("key").length() == 0 ? null : text("key");
    }

    /** Files with the public keys of drives. */
    public List<String> allowedKeyFiles() {
        String files = text("allow");
        return files.length() == 0 ? Collections.<String>emptyList()
            : Arrays.asList(files.split("\\s*,\\s*"));
    }

    /** Address of the FRI client; {@link #DRIVE} for the address of the connected drive. */
    public String friClient() {
        return text("fri_client");
    }

    public int friPort() {
        return number("fri_port");
    }

    public int friPeriodMs() {
        return number("fri_period_ms");
    }

    public int friReceiveMultiplier() {
        return number("fri_receive_multiplier");
    }

    /** Template of the tool at the flange; null without a tool. */
    public String tool() {
        return text("tool").length() == 0 ? null : text("tool");
    }

    /** Number of motions that are handed to the controller at once. */
    public int batch() {
        return number("batch");
    }

    /** Sunrise version from the settings; null if not set. */
    public String sunrise() {
        return text("sunrise").length() == 0 ? null : text("sunrise");
    }

    /** Robot at the cabinet, from the settings; null if not set. */
    public RobotIdentity robot() {
        return text("robot").length() == 0 ? null
            : RobotIdentity.of(text("robot"), Double.parseDouble(text("flange_mm")));
    }

    public List<DeclaredSignal> signals() {
        return Collections.unmodifiableList(signals);
    }

    /** All settings, for people. */
    @Override
    public String toString() {
        String listens = address() + ":" + instructionsPort() + " and :" + statePort();
        String keys = keyFile() == null ? "no keys, this machine only" : "keys of "
            + allowedKeyFiles();
        return "listens at " + listens + " (" + keys + "); FRI to " + friClient() + ":" + friPort()
            + " every "
            + friPeriodMs() + " ms, an answer every " + friReceiveMultiplier() + "; tool "
            + (tool() == null ? "none" : tool()) + "; robot "
            + (robot() == null ? "not stated" : robot()) + "; " + signals.size() + " signals";
    }
}
