package com.kuka.roboticsAPI.executionModel;

/** A stub of ours: see src/stubs/README.md. */
public class CommandInvalidException extends RuntimeException {
    private static final long serialVersionUID = 1L;

    public CommandInvalidException(String message) {
        super(message);
    }
}
