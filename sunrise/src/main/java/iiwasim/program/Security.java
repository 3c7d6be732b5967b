package iiwasim.program;

import java.io.IOException;
import java.util.ArrayList;
import java.util.Collection;
import java.util.List;

/** Who may instruct the robot program: processes of this machine, or drives whose keys are known. */
public final class Security {
    private final KeyFile own;
    private final List<KeyFile> allowed;

    private Security(KeyFile own, List<KeyFile> allowed) {
        this.own = own;
        this.allowed = allowed;
    }

    /** Without keys: this machine only. */
    public static Security open() {
        return new Security(null, new ArrayList<KeyFile>());
    }

    /**
     * With keys, for other machines.
     *
     * @throws IOException the own file is not a secret one, or one of the others is
     */
    public static Security withKeys(KeyFile own, Collection<KeyFile> allowed) throws IOException {
        if (own.secretKey() == null) {
            throw new IOException("the program's own key file has no secret key: give the .key file");
        }
        for (KeyFile key : allowed) {
            if (key.secretKey() != null) {
                throw new IOException("a key file of a drive contains a secret key, which only its owner should have:"
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
