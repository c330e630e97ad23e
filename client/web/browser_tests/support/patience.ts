/** The longest wait for an event, ms. Only a broken program needs more: the first pictures compile shaders. */
export const patience = 240_000;
