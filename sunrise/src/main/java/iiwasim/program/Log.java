package iiwasim.program;

/** Where the program tells people what happens: the smartPAD, or standard error. */
public interface Log {
    void info(String text);

    void warn(String text);
}
