package iiwasim.program;

/** Waiting for threads. */
public final class Threads {
    private Threads() {
    }

    /**
     * Waits for the end of a thread, not for ever, and whether the caller is interrupted or not: a cabinet interrupts a program
     * to end it, and what is not waited for is left behind.
     *
     * @return whether it has ended
     */
    public static boolean join(Thread thread, long milliseconds) {
        boolean wasInterrupted = Thread.interrupted();
        long until = System.nanoTime() + milliseconds * 1000000;
        for (long left = milliseconds; left > 0 && thread.isAlive(); left = (until - System.nanoTime()) / 1000000) {
            try {
                thread.join(left);
            } catch (InterruptedException interrupt) {
                wasInterrupted = true;
            }
        }
        if (wasInterrupted) {
            Thread.currentThread().interrupt();
        }
        return !thread.isAlive();
    }
}
