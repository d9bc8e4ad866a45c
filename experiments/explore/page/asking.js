// Questions to the live page's own server.

/** A function ask(path, question): its answer, or an error with the server's one line. */
export function askerOf(token) {
  return async (path, question) => {
    let response, answer;
    try {
      response = await fetch(path, {
        method: "POST", body: JSON.stringify(question),
        headers: { "Content-Type": "application/json", "X-Icage-Token": token },
      });
      answer = await response.json();
    } catch {
      throw new Error("The server does not answer any more: start `icage explore` again.");
    }
    if (!response.ok || answer.error) throw new Error(answer.error);
    return answer;
  };
}

const AGAIN = 300; // [ms] until a question is asked again that another page's has displaced

/**
 * Questions that come faster than answers: one is under way, of those that wait only the newest is
 * asked. `told(answer, question)` and `failed(error, question)` hear of each that was; both are
 * not called for answers that came after `forget()`.
 */
export function newestOf(ask, told, failed) {
  let busy = false, next = null, turn = 0;
  const put = async (question) => {
    if (busy) {
      next = question;
      return;
    }
    busy = true;
    const mine = turn;
    let hear;
    try {
      const answer = await ask(question);
      if (answer.out_of_date) {
        await new Promise((done) => { setTimeout(done, AGAIN); });
        next ??= mine === turn ? question : null;
        hear = () => {};
      } else hear = () => told(answer, question);
    } catch (error) {
      hear = () => failed(error, question);
    }
    busy = false;
    if (mine === turn) hear();
    if (next !== null && !busy) {
      const later = next;
      next = null;
      put(later);
    }
  };
  const forget = () => { turn += 1; next = null; };
  return { put, forget };
}
