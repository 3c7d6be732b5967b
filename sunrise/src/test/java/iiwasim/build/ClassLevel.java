package iiwasim.build;

import java.io.ByteArrayOutputStream;
import java.io.File;
import java.io.FileInputStream;
import java.io.FileOutputStream;
import java.io.IOException;
import java.io.InputStream;
import java.util.Calendar;
import java.util.GregorianCalendar;
import java.util.zip.ZipEntry;
import java.util.zip.ZipInputStream;
import java.util.zip.ZipOutputStream;

/**
 * Relabels the classes of a jar as Java 6, and refuses a jar with other class versions.
 *
 * <p>JeroMQ 0.4.3 is labelled as Java 7 without using Java 7: only two bytes of each class keep it
 * off a cabinet. The build also checks the used API, and the tests run on the relabelled classes.
 */
public final class ClassLevel {
    private static final int JAVA_6 = 50;
    private static final int JAVA_7 = 51;
    private static final int MAGIC = 0xCAFEBABE;
    private static final long MAX_BYTES = 700 * 1024;

    private ClassLevel() {
    }

    /** Relabels the jars given after a folder; the folder gets the classes of the first jar. */
    public static void main(String[] arguments) throws IOException {
        for (int i = 1; i < arguments.length; i++) {
            File jar = new File(arguments[i]);
            relabel(jar, i == 1 ? new File(arguments[0]) : null);
            if (jar.length() > MAX_BYTES) {
                throw new IOException(jar + " has " + jar.length() + " bytes; at most " + MAX_BYTES
                    + " are meant for a cabinet");
            }
        }
    }

    /** Relabels a jar, and writes its classes into a folder unless the folder is null. */
    static void relabel(File jar, File classes) throws IOException {
        File made = new File(jar.getPath() + ".part");
        int count = 0;
        ZipInputStream in = new ZipInputStream(new FileInputStream(jar));
        ZipOutputStream out = new ZipOutputStream(new FileOutputStream(made));
        try {
            for (ZipEntry entry = in.getNextEntry(); entry != null; entry = in.getNextEntry()) {
                byte[] content = content(in);
                boolean isClass = entry.getName().endsWith(".class");
                if (isClass) {
                    label(content, entry.getName());
                    count++;
                }
                if (isClass && classes != null) {
                    write(new File(classes, entry.getName()), content);
                }
                ZipEntry copy = new ZipEntry(entry.getName());
                // A fixed time makes the jar reproducible.
                copy.setTime(new GregorianCalendar(2000, Calendar.JANUARY, 1).getTimeInMillis());
                out.putNextEntry(copy);
                out.write(content);
                out.closeEntry();
            }
        } finally {
            in.close();
            out.close();
        }
        if (!jar.delete() || !made.renameTo(jar)) {
            throw new IOException("cannot replace " + jar);
        }
        System.out.println(jar.getName() + ": " + count + " classes for Java 6 or older, "
            + jar.length() / 1024 + " kB");
    }

    private static void write(File file, byte[] content) throws IOException {
        file.getParentFile().mkdirs();
        FileOutputStream out = new FileOutputStream(file);
        try {
            out.write(content);
        } finally {
            out.close();
        }
    }

    private static void label(byte[] content, String name) throws IOException {
        int magic = content.length < 8 ? 0 : number(content, 0) << 16 | number(content, 2);
        int version = content.length < 8 ? 0 : number(content, 6);
        if (magic != MAGIC || version > JAVA_7) {
            throw new IOException(name + " has the version " + version + ", and a cabinet takes "
                + JAVA_6 + " at most");
        }
        if (name.startsWith("com/kuka/")) {
            throw new IOException(name + " does not belong into the jar");
        }
        if (version == JAVA_7) {
            content[7] = (byte) JAVA_6;
        }
    }

    private static int number(byte[] content, int at) {
        return (content[at] & 0xff) << 8 | content[at + 1] & 0xff;
    }

    private static byte[] content(InputStream in) throws IOException {
        ByteArrayOutputStream content = new ByteArrayOutputStream();
        byte[] buffer = new byte[8192];
        for (int length = in.read(buffer); length >= 0; length = in.read(buffer)) {
            content.write(buffer, 0, length);
        }
        return content.toByteArray();
    }
}
