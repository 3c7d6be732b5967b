package iiwasim.sunrise;

import com.kuka.roboticsAPI.executionModel.ExecutionState;
import com.kuka.roboticsAPI.executionModel.IExecutionContainer;
import com.kuka.roboticsAPI.motionModel.IMotion;
import com.kuka.roboticsAPI.motionModel.IMotionContainer;
import com.kuka.roboticsAPI.motionModel.IMotionContainerListener;

import iiwasim.program.Backend;
import iiwasim.program.Messages;
import iiwasim.program.Outcome;
import iiwasim.program.Refusal;
import iiwasim.program.Threads;

import java.util.ArrayList;
import java.util.HashSet;
import java.util.List;
import java.util.Set;

/**
 * A run on the controller, from its beginning until the robot is at rest.
 *
 * <p>A separate thread follows the run. Callbacks of the controller only set fields and wake this
 * thread. An early end cancels all remaining motions; a run is never resumed.
 */
abstract class Run {
    /** Poll interval for the end of motions, in case that a callback is missing, in ms. */
    private static final long LOOK_MS = 200;

    /** Maximum time for the robot to stop. */
    private static final long REST_MS = 5000;

    private final Backend.Listener listener;
    private final List<IMotionContainer> containers = new ArrayList<IMotionContainer>();
    private final Set<IMotionContainer> cancelled = new HashSet<IMotionContainer>();
    private final Thread thread;
    private Refusal error;
    /**
     * True once the run is complete: errors of the controller about a cancelled hold are ignored
     * then.
     */
    private boolean isComplete;
    private boolean hasEnded;

    /** Wakes the thread at each change. */
    private final IMotionContainerListener waker = new IMotionContainerListener() {
        @Override
        public void onStateChanged(IExecutionContainer container, ExecutionState state) {
            wake();
        }

        @Override
        public void containerFinished(IMotionContainer container) {
            wake();
        }

        @Override
        public void motionStarted(IMotion motion) {
            // The drive observes the motion over FRI.
        }

        @Override
        public void motionFinished(IMotion motion) {
            // A batch is one container.
        }
    };

    Run(Backend.Listener listener, String name) {
        this.listener = listener;
        thread = new Thread(new Runnable() {
            @Override
            public void run() {
                follow();
            }
        }, name);
        thread.setDaemon(true);
    }

    /** Hands the first motions to the controller. */
    abstract void start() throws Refusal;

    /**
     * Waits for the end of the started motions, and starts the next ones. Remaining motions are
     * cancelled when it returns.
     */
    abstract void proceed() throws Refusal, InterruptedException;

    /**
     * Begins the run. If the controller refuses the first motions, the robot is at rest on return.
     */
    final void begin() throws Refusal {
        boolean isStarted = false;
        try {
            start();
            isStarted = true;
        } catch (RuntimeException refusal) {
            throw SunriseBackend.refused(refusal);
        } finally {
            if (!isStarted) {
                cancelAll();
                awaitRest();
                synchronized (this) {
                    hasEnded = true;
                    notifyAll();
                }
            }
        }
        thread.start();
    }

    private void follow() {
        try {
            proceed();
            synchronized (this) {
                isComplete = error == null;
            }
            cancelAll();
        } catch (Refusal refusal) {
            abort(refusal);
        } catch (RuntimeException refusal) {
            abort(SunriseBackend.refused(refusal));
        } catch (InterruptedException interrupt) {
            abort(Refusal.robot("the robot program has ended"));
        }
        boolean isAtRest = awaitRest();
        Refusal why;
        synchronized (this) {
            if (!isAtRest) {
                String before = error == null ? "" : error.getMessage() + "; ";
                error = Refusal.robot(
                    before + "the controller has not reported that the arm is at rest");
            }
            why = error;
            hasEnded = true;
            notifyAll();
        }
        listener.ended(Outcome.untimed(why));
    }

    /** Ends the run with an error, unless it has ended or already has an error. */
    final void abort(Refusal why) {
        synchronized (this) {
            if (hasEnded) {
                return;
            }
            if (error == null && !isComplete) {
                error = why;
            }
            notifyAll();
        }
        cancelAll();
    }

    final synchronized boolean hasEnded() {
        return hasEnded;
    }

    final void awaitEnd() {
        join(thread);
    }

    /** Registers a container, which is cancelled with the others. */
    final void add(IMotionContainer container) {
        boolean isLate;
        synchronized (this) {
            containers.add(container);
            isLate = error != null;
        }
        if (isLate) {
            cancel(container);
        }
    }

    final IMotionContainerListener waker() {
        return waker;
    }

    /** Fails if the run was aborted. */
    final synchronized void check() throws Refusal {
        if (error != null) {
            throw error;
        }
    }

    /**
     * Waits until all containers have finished; fails if one of them has an error, or the run was
     * aborted.
     */
    final void awaitContainers() throws Refusal, InterruptedException {
        for (IMotionContainer container : snapshot()) {
            while (!container.isFinished()) {
                check();
                pause(LOOK_MS);
            }
            if (container.hasError()) {
                throw Refusal.robot("the controller has aborted the motion: " + text(container));
            }
        }
        check();
        synchronized (this) {
            containers.clear();
        }
    }

    /** Waits for a change, at most for the given time. */
    final synchronized void pause(long milliseconds) throws InterruptedException {
        wait(milliseconds);
    }

    private synchronized void wake() {
        notifyAll();
    }

    private void cancelAll() {
        for (IMotionContainer container : snapshot()) {
            cancel(container);
        }
    }

    /** Cancels a container once, as callbacks of the controller may call this method again. */
    private void cancel(IMotionContainer container) {
        synchronized (this) {
            if (!cancelled.add(container)) {
                return;
            }
        }
        try {
            if (!container.isFinished()) {
                container.cancel();
            }
        } catch (RuntimeException refusal) {
            // The other containers still have to be cancelled, and the run waits for this one.
            return;
        }
    }

    private boolean awaitRest() {
        long until = System.nanoTime() + REST_MS * 1000000;
        try {
            for (IMotionContainer container : snapshot()) {
                while (!container.isFinished()) {
                    if (System.nanoTime() > until) {
                        return false;
                    }
                    pause(LOOK_MS);
                }
            }
            return true;
        } catch (InterruptedException interrupt) {
            return false;
        } catch (RuntimeException refusal) {
            return false;
        }
    }

    private synchronized List<IMotionContainer> snapshot() {
        return new ArrayList<IMotionContainer>(containers);
    }

    private static String text(IMotionContainer container) {
        String message = container.getErrorMessage();
        return message == null ? "it gives no reason" : Messages.line(message);
    }

    /** Waits for the end of a thread, for a limited time. */
    static void join(Thread thread) {
        Threads.join(thread, REST_MS + 2 * LOOK_MS);
    }
}
