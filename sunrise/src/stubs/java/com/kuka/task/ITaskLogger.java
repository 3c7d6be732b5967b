package com.kuka.task;

/** A stub of ours: see src/stubs/README.md. */
public interface ITaskLogger {
    void info(String text);

    void warn(String text);

    void error(String text);
}
