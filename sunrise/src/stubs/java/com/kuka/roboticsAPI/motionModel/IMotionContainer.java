package com.kuka.roboticsAPI.motionModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public interface IMotionContainer {
    void cancel();

    boolean isFinished();

    boolean hasError();

    String getErrorMessage();
}
