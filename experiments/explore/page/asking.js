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
      throw lost("The server does not answer any more: start `icage explore` again.");
    }
    if (answer.over) throw lost(answer.error);
    if (!response.ok || answer.error) throw new Error(answer.error);
    return answer;
  };
}

/** An error that says nothing of what was asked. */
function lost(words) {
  return Object.assign(new Error(words), { lost: true });
}

const AGAIN = 300; // [ms] until a question is asked again that another page's has displaced

/**
 * Questions that come faster than answers: `most` are under way, of those that wait only the newest
 * is asked. `told(answer, question)` and `failed(error, question)` hear of each in the order of the
 * questions; of answers that came after `forget()`, or after that to a newer question, nobody does.
 */
export function newestOf(ask, told, failed, most = 1) {
  let busy = 0, next = null, asked = 0, heard = 0;
  const put = async (question) => {
    if (busy >= most) {
      next = question;
      return;
    }
    busy += 1;
    const mine = ++asked;
    let hear;
    try {
      const answer = await ask(question);
      if (answer.out_of_date) {
        await new Promise((done) => { setTimeout(done, AGAIN); });
        if (mine === asked) next ??= question;
      } else hear = () => told(answer, question);
    } catch (error) {
      hear = () => failed(error, question);
    }
    busy -= 1;
    if (mine > heard && hear) {
      heard = mine;
      hear();
    }
    if (next !== null && busy < most) {
      const later = next;
      next = null;
      put(later);
    }
  };
  const forget = () => {
    asked += 1;
    heard = asked;
    next = null;
  };
  return { put, forget };
}
