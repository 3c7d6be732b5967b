package com.kuka.connectivity.fastRobotInterface;

import java.util.ArrayList;
import java.util.Collections;
import java.util.List;
import java.util.concurrent.TimeUnit;
import java.util.concurrent.TimeoutException;

/** A stub of ours: see src/stubs/README.md. */
public class FRISession {
    /** What sessions were asked for, for tests. */
    public static final List<String> CALLS = Collections.synchronizedList(new ArrayList<String>());
    /** The state that all of them are in. */
    public static volatile FRIChannelInformation.FRISessionState state = FRIChannelInformation.FRISessionState.MONITORING_READY;

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
