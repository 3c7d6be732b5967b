package iiwasim.program;

/** Functions that wait for threads. */
public final class Threads {
    private Threads() {
    }

    /**
     * Waits for the end of a thread, for a limited time, even if the caller is interrupted: a
     * cabinet interrupts a program to end it, and threads that nobody waits for are left behind.
     *
     * @return true if the thread has ended
     */
    public static boolean join(Thread thread, long milliseconds) {
        boolean wasInterrupted = Thread.interrupted();
        long until = System.nanoTime() + milliseconds * 1000000;
        for (long left = milliseconds; left > 0
            && thread.isAlive(); left = (until - System.nanoTime()) / 1000000) {
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
