package com.kuka.connectivity.fastRobotInterface;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class FRIChannelInformation {
    /** Stub of the KUKA type. */
    public enum FRISessionState { IDLE, MONITORING_WAIT, MONITORING_READY, COMMANDING_WAIT,
        COMMANDING_ACTIVE }

    /** Stub of the KUKA type. */
    public enum FRIConnectionQuality { POOR, FAIR, GOOD, EXCELLENT }

    private final FRISessionState state;

    public FRIChannelInformation(FRISessionState state) {
        this.state = state;
    }

    public FRISessionState getFRISessionState() {
        return state;
    }

    public FRIConnectionQuality getQuality() {
        return FRIConnectionQuality.GOOD;
    }
}
