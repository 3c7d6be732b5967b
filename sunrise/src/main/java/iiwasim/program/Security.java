package iiwasim.program;

import java.io.IOException;
import java.util.ArrayList;
import java.util.Collection;
import java.util.List;

/** Access control of the robot program: processes of this machine, or drives with known keys. */
public final class Security {
    private final KeyFile own;
    private final List<KeyFile> allowed;

    private Security(KeyFile own, List<KeyFile> allowed) {
        this.own = own;
        this.allowed = allowed;
    }

    /** Access without keys, from this machine only. */
    public static Security open() {
        return new Security(null, new ArrayList<KeyFile>());
    }

    /**
     * Access with keys, also from other machines.
     *
     * @throws IOException {@code own} is not a secret key file, or one of {@code allowed} is
     */
    public static Security withKeys(KeyFile own, Collection<KeyFile> allowed) throws IOException {
        if (own.secretKey() == null) {
            throw new IOException(
                "the program's own key file has no secret key: give the .key file");
        }
        for (KeyFile key : allowed) {
            if (key.secretKey() != null) {
                throw new IOException(
                    "a key file of a drive contains a secret key, which only its owner should have:"
                    + " give the .pub file");
            }
        }
        if (allowed.isEmpty()) {
            throw new IOException("no drive may connect: give its .pub file");
        }
        return new Security(own, new ArrayList<KeyFile>(allowed));
    }

    boolean hasKeys() {
        return own != null;
    }

    KeyFile own() {
        return own;
    }

    boolean admits(byte[] key) {
        for (KeyFile known : allowed) {
            if (known.isOf(key)) {
                return true;
            }
        }
        return false;
    }
}
