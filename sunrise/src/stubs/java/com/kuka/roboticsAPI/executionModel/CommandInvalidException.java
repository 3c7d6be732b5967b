package com.kuka.roboticsAPI.executionModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class CommandInvalidException extends RuntimeException {
    private static final long serialVersionUID = 1L;

    public CommandInvalidException(String message) {
        super(message);
    }
}
