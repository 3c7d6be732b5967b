package iiwasim.program;

import org.zeromq.ZMQ;

import java.io.BufferedReader;
import java.io.IOException;
import java.io.InputStream;
import java.io.InputStreamReader;
import java.util.Arrays;

/**
 * A CURVE key file in the format of {@code iiwasim keygen} and CZMQ: lines {@code public-key =
 * "..."} and, in a secret key file, {@code secret-key = "..."}, of 40 Z85 characters each.
 */
public final class KeyFile {
    private static final String DIGITS =
        "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ.-:+=^!/*?&<>()[]{}@%$#";
    private static final int CHARS = 40;

    private final byte[] publicKey;
    private final byte[] secretKey;

    private KeyFile(byte[] publicKey, byte[] secretKey) {
        this.publicKey = publicKey;
        this.secretKey = secretKey;
    }

    /**
     * Reads a key file, and closes it.
     *
     * @param name name of the file, for messages
     * @throws IOException the file cannot be read, or is not a key file
     */
    public static KeyFile read(InputStream in, String name) throws IOException {
        byte[] publicKey = null;
        byte[] secretKey = null;
        BufferedReader lines = new BufferedReader(new InputStreamReader(in, "UTF-8"));
        try {
            int number = 0;
            for (String line = lines.readLine(); line != null; line = lines.readLine()) {
                number++;
                int equals = line.indexOf('=');
                String key = equals < 0 ? line.trim() : line.substring(0, equals).trim();
                if (key.equals("public-key")) {
                    publicKey = decode(line.substring(equals + 1).trim(), name, number);
                } else if (key.equals("secret-key")) {
                    secretKey = decode(line.substring(equals + 1).trim(), name, number);
                }
            }
        } finally {
            lines.close();
        }
        if (publicKey == null) {
            throw new IOException(
                name + " is not a key file: it has no line `public-key = \"...\"`");
        }
        return new KeyFile(publicKey, secretKey);
    }

    /** Decodes a key. Messages do not show the key, as it may be secret. */
    private static byte[] decode(String quoted, String name, int line) throws IOException {
        boolean isQuoted = quoted.length() == CHARS + 2 && quoted.startsWith("\"")
            && quoted.endsWith("\"");
        String text = isQuoted ? quoted.substring(1, CHARS + 1) : "";
        for (int i = 0; i < text.length(); i++) {
            isQuoted &= DIGITS.indexOf(text.charAt(i)) >= 0;
        }
        if (!isQuoted) {
            throw new IOException(name + ", line " + line + ": a key has " + CHARS
                + " characters of Z85 in double quotes");
        }
        return ZMQ.Curve.z85Decode(text);
    }

    public byte[] publicKey() {
        return publicKey.clone();
    }

    /** The secret key; null in a public key file. */
    public byte[] secretKey() {
        return secretKey == null ? null : secretKey.clone();
    }

    boolean isOf(byte[] key) {
        return Arrays.equals(publicKey, key);
    }
}
