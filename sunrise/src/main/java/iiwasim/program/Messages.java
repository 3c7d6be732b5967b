package iiwasim.program;

import java.util.Locale;

/** Texts for people, in network messages. */
public final class Messages {
    /** Longest message, in characters; all of them are ASCII. */
    static final int MAX_CHARS = 500;

    /** Longest excerpt of a received text, in characters. */
    private static final int MAX_EXCERPT = 60;

    private Messages() {
    }

    /** A text on one line, of limited length, in printable ASCII. */
    public static String line(String text) {
        StringBuilder line = new StringBuilder();
        for (int i = 0; i < text.length(); i++) {
            char letter = text.charAt(i);
            if (letter == '\n' || letter == '\r' || letter == '\t') {
                line.append(' ');
            } else {
                append(line, letter);
            }
            if (line.length() > MAX_CHARS - 3) {
                line.setLength(MAX_CHARS - 3);
                return line.append("...").toString();
            }
        }
        return line.toString();
    }

    /** The beginning of a received text. */
    public static String excerpt(String text) {
        StringBuilder excerpt = new StringBuilder();
        for (int i = 0; i < text.length(); i++) {
            if (excerpt.length() >= MAX_EXCERPT) {
                return excerpt.append("...").toString();
            }
            append(excerpt, text.charAt(i));
        }
        return excerpt.toString();
    }

    /** The message of an exception, also of one without a message. */
    public static String of(Throwable error) {
        String message = error.getMessage();
        return message == null || message.length() == 0 ? error.getClass().getSimpleName()
            : message;
    }

    /** An angle in rad, in degrees with two decimals. */
    public static String degrees(double rad) {
        return String.format(Locale.ROOT, "%.2f deg", Math.toDegrees(rad));
    }

    private static void append(StringBuilder text, char letter) {
        if (letter >= ' ' && letter <= '~') {
            text.append(letter);
        } else {
            text.append(String.format(Locale.ROOT, "\\u{%x}", (int) letter));
        }
    }
}
