package com.kuka.task;

/** Stub of the KUKA type: see src/stubs/README.md. */
public interface ITaskLogger {
    void info(String text);

    void warn(String text);

    void error(String text);
}
