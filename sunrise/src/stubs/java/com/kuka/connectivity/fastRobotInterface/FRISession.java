package com.kuka.connectivity.fastRobotInterface;

import java.util.ArrayList;
import java.util.Collections;
import java.util.List;
import java.util.concurrent.TimeUnit;
import java.util.concurrent.TimeoutException;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class FRISession {
    /** Calls of all sessions, for tests. */
    public static final List<String> CALLS = Collections.synchronizedList(new ArrayList<String>());
    /** State of all sessions. */
    public static volatile FRIChannelInformation.FRISessionState state =
        FRIChannelInformation.FRISessionState.MONITORING_READY;

    public FRISession(FRIConfiguration configuration) {
        CALLS.add("open " + configuration.client + ":" + configuration.port);
    }

    public void await(long timeout, TimeUnit unit) throws TimeoutException {
        if (state == FRIChannelInformation.FRISessionState.IDLE) {
            throw new TimeoutException("no answer of the client");
        }
    }

    public FRIChannelInformation getFRIChannelInformation() {
        return new FRIChannelInformation(state);
    }

    public void close() {
        CALLS.add("close");
    }
}
