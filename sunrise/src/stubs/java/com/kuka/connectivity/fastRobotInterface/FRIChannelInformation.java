package com.kuka.connectivity.fastRobotInterface;

/** A stub of ours: see src/stubs/README.md. */
public class FRIChannelInformation {
    /** A stub of ours. */
    public enum FRISessionState { IDLE, MONITORING_WAIT, MONITORING_READY, COMMANDING_WAIT, COMMANDING_ACTIVE }

    /** A stub of ours. */
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
