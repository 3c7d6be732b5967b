package iiwasim.program;

/** Log for people: the smartPAD, or standard error. */
public interface Log {
    void info(String text);

    void warn(String text);
}
